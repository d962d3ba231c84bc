// Half springs read as words: ris_half_spring of sim_shared.h, five to a spring (vk_state.c asserts their places).

layout(set = 0, binding = RIS_TEXEL_HALF_SPRING) uniform usamplerBuffer half_spring_word;

uint half_spring_uint(uint word)
{
    return texelFetch(half_spring_word, int(word)).x;
}

ris_half_spring half_spring(uint h)
{
    const uint first = 5u * h;
    return ris_half_spring(half_spring_uint(first), uintBitsToFloat(half_spring_uint(first + 1u)),
                           uintBitsToFloat(half_spring_uint(first + 2u)), uintBitsToFloat(half_spring_uint(first + 3u)),
                           uintBitsToFloat(half_spring_uint(first + 4u)));
}
