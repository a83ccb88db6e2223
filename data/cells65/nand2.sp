* nand2: two-input NAND, n 400 nm, p 450 nm
* made by draw.py; w and l in metres, $ the centre of the drawn gate
.subckt nand2 A B Y VDD VSS
MN1 VSS A X VSS nmos w=400e-9 l=65e-9 $ x=250.5 y=400 nm centre
MN2 Y B X VSS nmos w=400e-9 l=65e-9 $ x=500.5 y=400 nm centre
MP1 Y A VDD VDD pmos w=450e-9 l=65e-9 $ x=250.5 y=1130 nm centre
MP2 Y B VDD VDD pmos w=450e-9 l=65e-9 $ x=500.5 y=1130 nm centre
.ends nand2
