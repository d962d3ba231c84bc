// Common head of every simulation stage: extensions, shared structs, push constants, group size.
// Each stage declares only the buffers it touches, readonly where it only reads: binding numbers from sim_shared.h.
#extension GL_EXT_scalar_block_layout : require
#include "sim_shared.h"

layout(local_size_x = RIS_GROUP_NODE) in;
layout(push_constant, scalar) uniform push_block {
    ris_sim_push push;
};
