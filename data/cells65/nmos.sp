* nmos: single n transistor, W 1000 nm
* made by draw.py; w and l in metres, $ the centre of the drawn gate
.subckt nmos D G S B
M1 D G S B nmos w=1000e-9 l=65e-9 $ x=32.5 y=500 nm centre
.ends nmos
