* inverter: n 300 nm, p 450 nm
* made by draw.py; w and l in metres, $ the centre of the drawn gate
.subckt inverter A Y VDD VSS
MN1 Y A VSS VSS nmos w=300e-9 l=65e-9 $ x=250.5 y=450 nm centre
MP1 Y A VDD VDD pmos w=450e-9 l=65e-9 $ x=250.5 y=1130 nm centre
.ends inverter
