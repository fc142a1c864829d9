//! Draws lit scenes on the CPU
