// Counts the iterations that two loops really run, one after the other and with a condition no compiler can foresee.
#version 460
layout(local_size_x = 1) in;
layout(set = 0, binding = 0) buffer block { uint first_wanted, second_wanted, first_run, second_run, step; };

void main()
{
    uint a = 0u, b = 0u;
    for (uint i = 0u; i < first_wanted; i += step) {
        a += step;
    }
    for (uint i = 0u; i < second_wanted; i += step) {
        b += step;
    }
    first_run = a;
    second_run = b;
}
