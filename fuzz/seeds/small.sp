* all that a netlist may have
.param lmin=65n wn='2*100n' ratio = 1.5
.global vdd gnd
.option scale=1 m=2
.model nch nmos level=54 dlc=-5n lint=0
.model pch pmos (level = 54 lint = 3n)
.subckt inv a y vdd gnd w=200n m=1
mn y a gnd gnd nch l=lmin w='wn*m' nf=2 $ x=120 y=340
mp y a vdd vdd pch l=lmin
+ w={ratio*wn + w} as=1.2e-14
.ends inv
.subckt pair a z vdd gnd
x1 a b vdd gnd inv w=300n
xtwo b z vdd gnd / inv m=2
c1 a gnd 1f
.ends
.include none.sp
.end
