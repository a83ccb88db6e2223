* the transistors of eda_gates_sample, which share their gate
.subckt sample A Y Z VDD VSS
MN1 Y A VSS VSS nmos w=200e-9 l=60e-9
MP1 Z A VDD VDD pmos w=300e-9 l=60e-9
.ends sample
