#include "base/real.h"

#include <math.h>

double ris__exp(double x)
{
    /* x = n ln 2 + r, |r| <= ln 2 / 2; ln 2 in two parts, the first with 21 zero bits at its end */
    const double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
    if (!(x > -700)) {
        return 0;
    }
    x = x < 700 ? x : 700;
    const double n = floor(x * 1.44269504088896338700 + 0.5), r = (x - n * ln2_high) - n * ln2_low;
    double sum = 1;
    for (int k = 14; k > 0; k--) { /* 0.35^15 / 15! < 1e-19 */
        sum = 1 + sum * r / k;
    }
    return ldexp(sum, (int)n);
}
