* SPDX-License-Identifier: BSD-3-Clause
* A BSIM4 card of opcflow's own, for simulating its circuits: no foundry's, and a
* model of nothing but the currents of ptm65.yaml. Made by fit_opcflow65.py.

.model nmos nmos
+ level = 54  version = 4.5  binunit = 1  paramchk = 1  mobmod = 0
+ capmod = 2  rdsmod = 0  tnom = 27  toxe = 1.8e-9  nsd = 2e20
+ ngate = 2e20  k1 = 0.4  k2 = 0  k3 = 0  dvt0w = 0
+ delta = 0.01  bgidl = 2.3e8  cjs = 5e-4  cjd = 5e-4  cjsws = 5e-10
+ cjswd = 5e-10  cjswgs = 3e-10  cjswgd = 3e-10  vth0 = 0.35711  u0 = 0.045112
+ vsat = 1.774e+05  lint = 1.8536e-08  rdsw = 360.44  nfactor = 1.5975  voff = -0.073991
+ eta0 = 0.0071171  dsub = 0.094957  dvt0 = 2.4796  dvt1 = 1.7432  pclm = 0.011142
+ cdscd = 0.00047627  lpe0 = 3.9085e-09  a0 = 0.064073  ndep = 2.2749e+18  agidl = 8.0649e-09
+ voffl = 1.0243e-10  minv = 0.70678  xj = 3.8547e-08  pdiblc1 = 0.0085542  pdiblc2 = 0.0008282
+ ua = 6.1551e-10

.model pmos pmos
+ level = 54  version = 4.5  binunit = 1  paramchk = 1  mobmod = 0
+ capmod = 2  rdsmod = 0  tnom = 27  toxe = 1.8e-9  nsd = 2e20
+ ngate = 2e20  k1 = 0.4  k2 = 0  k3 = 0  dvt0w = 0
+ delta = 0.01  bgidl = 2.3e8  cjs = 5e-4  cjd = 5e-4  cjsws = 5e-10
+ cjswd = 5e-10  cjswgs = 3e-10  cjswgd = 3e-10  vth0 = -0.41071  u0 = 0.0065557
+ vsat = 1.0434e+05  lint = 1.8811e-08  rdsw = 159.22  nfactor = 1.9019  voff = -0.12618
+ eta0 = 0.0077751  dsub = 0.090562  dvt0 = 1.4638  dvt1 = 1.5064  pclm = 0.047243
+ cdscd = 0.0013318  lpe0 = 6.1516e-09  a0 = 1.5431  ndep = 2.2609e+18  agidl = 5.3494e-10
+ voffl = -1.9689e-10  minv = -0.48777  xj = 2.8924e-08  pdiblc1 = 0.0072817  pdiblc2 = 0.00076895
+ ua = 5.2049e-10
