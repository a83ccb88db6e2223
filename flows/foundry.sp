* The four inner cells of an array of 6 x 6 single-port memory cells of SkyWater, mirrored
* about shared edges (flows/foundry.yaml). Q and QB are the storage nodes, the numbers are
* column and row. The comment has the centre of the drawn gate.
.subckt foundry WL2 WL3 BL2 BR2 BL3 BR3 VPWR VGND
MAL22 BL2 WL2 Q22 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=2660 y=4545 nm
MDL22 Q22 QB22 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=2695 y=4145 nm
MPL22 Q22 QB22 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3340 y=4145 nm
MAR22 BR2 WL2 QB22 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=2660 y=3355 nm
MDR22 QB22 Q22 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=2695 y=3755 nm
MPR22 QB22 Q22 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3340 y=3755 nm
MAL32 BL3 WL2 Q32 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=4540 y=4545 nm
MDL32 Q32 QB32 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=4505 y=4145 nm
MPL32 Q32 QB32 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3860 y=4145 nm
MAR32 BR3 WL2 QB32 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=4540 y=3355 nm
MDR32 QB32 Q32 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=4505 y=3755 nm
MPR32 QB32 Q32 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3860 y=3755 nm
MAL23 BL2 WL3 Q23 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=2660 y=4935 nm
MDL23 Q23 QB23 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=2695 y=5335 nm
MPL23 Q23 QB23 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3340 y=5335 nm
MAR23 BR2 WL3 QB23 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=2660 y=6125 nm
MDR23 QB23 Q23 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=2695 y=5725 nm
MPR23 QB23 Q23 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3340 y=5725 nm
MAL33 BL3 WL3 Q33 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=4540 y=4935 nm
MDL33 Q33 QB33 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=4505 y=5335 nm
MPL33 Q33 QB33 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3860 y=5335 nm
MAR33 BR3 WL3 QB33 VGND sky130_fd_pr__special_nfet_pass w=140n l=150n $ x=4540 y=6125 nm
MDR33 QB33 Q33 VGND VGND sky130_fd_pr__special_nfet_latch w=210n l=150n $ x=4505 y=5725 nm
MPR33 QB33 Q33 VPWR VPWR sky130_fd_pr__special_pfet_pass w=140n l=150n $ x=3860 y=5725 nm
.ends foundry
