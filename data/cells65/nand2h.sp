* nand2h: two-input NAND with horizontal gates
* made by draw.py; w and l in metres, $ the centre of the drawn gate
.subckt nand2h A B Y VDD VSS
MN1 VSS A X VSS nmos w=400e-9 l=65e-9 $ x=1305 y=250.5 nm centre
MN2 Y B X VSS nmos w=400e-9 l=65e-9 $ x=1305 y=500.5 nm centre
MP1 Y A VDD VDD pmos w=450e-9 l=65e-9 $ x=575 y=250.5 nm centre
MP2 Y B VDD VDD pmos w=450e-9 l=65e-9 $ x=575 y=500.5 nm centre
.ends nand2h
