#include "base/pcg.h"

uint32_t ris__pcg_next(ris_pcg *pcg)
{
    const uint64_t old = pcg->state;
    pcg->state = old * 6364136223846793005u + pcg->increment;
    const uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27), turn = (uint32_t)(old >> 59);
    return mixed >> turn | mixed << (-turn & 31);
}

ris_pcg ris__pcg_start(uint64_t seed, uint64_t sequence)
{
    ris_pcg pcg = {0, sequence << 1 | 1};
    ris__pcg_next(&pcg);
    pcg.state += seed;
    ris__pcg_next(&pcg);
    return pcg;
}

uint32_t ris__pcg_below(ris_pcg *pcg, uint32_t limit)
{
    const uint32_t uneven = -limit % limit; /* 2^32 mod limit: the first so many values are drawn again */
    uint32_t value;
    do {
        value = ris__pcg_next(pcg);
    } while (value < uneven);
    return value % limit;
}

double ris__pcg_unit(ris_pcg *pcg)
{
    return ris__pcg_next(pcg) * (1.0 / 4294967296.0);
}

double ris__pcg_normal(ris_pcg *pcg)
{
    double sum = -6;
    for (int i = 0; i < 12; i++) {
        sum += ris__pcg_unit(pcg);
    }
    return sum;
}
