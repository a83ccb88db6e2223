* The four inner cells of an array of 6 x 6 dual-port memory cells of SkyWater, as in
* foundry.sp. The pull-down transistors have two fingers each. All n-transistors have the
* width of the latch transistor, and its model.
.subckt foundry WLA2 WLB2 WLA3 WLB3 BLA2 BRA2 BLB2 BRB2 BLA3 BRA3 BLB3 BRB3 VPWR VGND
MAL22 BLA2 WLA2 Q22 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=3355 nm
MBL22 BLB2 WLB2 Q22 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=4545 nm
MDL22 Q22 QB22 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=3755 nm
MEL22 Q22 QB22 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=4145 nm
MPL22 Q22 QB22 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=6150 y=3745 nm
MAR22 BRA2 WLA2 QB22 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=3355 nm
MBR22 BRB2 WLB2 QB22 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=4545 nm
MDR22 QB22 Q22 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=3755 nm
MER22 QB22 Q22 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=4145 nm
MPR22 QB22 Q22 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=6150 y=4155 nm
MAL32 BLA3 WLA2 Q32 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=3355 nm
MBL32 BLB3 WLB2 Q32 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=4545 nm
MDL32 Q32 QB32 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=3755 nm
MEL32 Q32 QB32 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=4145 nm
MPL32 Q32 QB32 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=8250 y=3745 nm
MAR32 BRA3 WLA2 QB32 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=3355 nm
MBR32 BRB3 WLB2 QB32 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=4545 nm
MDR32 QB32 Q32 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=3755 nm
MER32 QB32 Q32 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=4145 nm
MPR32 QB32 Q32 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=8250 y=4155 nm
MAL23 BLA2 WLA3 Q23 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=6125 nm
MBL23 BLB2 WLB3 Q23 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=4935 nm
MDL23 Q23 QB23 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=5725 nm
MEL23 Q23 QB23 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=5095 y=5335 nm
MPL23 Q23 QB23 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=6150 y=5735 nm
MAR23 BRA2 WLA3 QB23 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=6125 nm
MBR23 BRB2 WLB3 QB23 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=4935 nm
MDR23 QB23 Q23 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=5725 nm
MER23 QB23 Q23 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=6905 y=5335 nm
MPR23 QB23 Q23 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=6150 y=5325 nm
MAL33 BLA3 WLA3 Q33 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=6125 nm
MBL33 BLB3 WLB3 Q33 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=4935 nm
MDL33 Q33 QB33 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=5725 nm
MEL33 Q33 QB33 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=9305 y=5335 nm
MPL33 Q33 QB33 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=8250 y=5735 nm
MAR33 BRA3 WLA3 QB33 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=6125 nm
MBR33 BRB3 WLB3 QB33 VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=4935 nm
MDR33 QB33 Q33 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=5725 nm
MER33 QB33 Q33 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=7495 y=5335 nm
MPR33 QB33 Q33 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=8250 y=5325 nm
.ends foundry
