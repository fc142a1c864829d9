//! Sample sequences and warps for light transport
