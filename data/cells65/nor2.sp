* nor2: two-input NOR, n 300 nm, p 600 nm
* made by draw.py; w and l in metres, $ the centre of the drawn gate
.subckt nor2 A B Y VDD VSS
MN1 Y A VSS VSS nmos w=300e-9 l=65e-9 $ x=250.5 y=450 nm centre
MN2 Y B VSS VSS nmos w=300e-9 l=65e-9 $ x=500.5 y=450 nm centre
MP1 VDD A X VDD pmos w=600e-9 l=65e-9 $ x=250.5 y=1205 nm centre
MP2 Y B X VDD pmos w=600e-9 l=65e-9 $ x=500.5 y=1205 nm centre
.ends nor2
