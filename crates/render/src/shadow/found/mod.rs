//! Silhouettes found on the GPU.

#[expect(dead_code, reason = "found, but not drawn from yet")]
mod basic;
