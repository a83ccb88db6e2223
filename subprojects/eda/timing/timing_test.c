/* SPDX-License-Identifier: BSD-3-Clause */
#include <eda/timing.h>
int main(void){return 0;}
