/* Functions of real numbers by + - * / alone: the same bits wherever IEEE 754 doubles are, unlike libm's. */
#pragma once

/* e to the power x, to 2 units in the last place; 0 below -700, e^700 above 700. */
double ris__exp(double x);
