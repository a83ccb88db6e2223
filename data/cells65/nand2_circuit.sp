* one NAND2 as a circuit of cells
.include "nand2.sp"
.subckt circuit A B Y VDD VSS
XU1 A B Y VDD VSS nand2
.ends circuit
