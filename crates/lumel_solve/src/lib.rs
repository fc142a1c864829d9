//! Solves for all bounces of light, with checkpoints
