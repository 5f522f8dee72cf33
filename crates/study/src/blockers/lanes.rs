//! Eight numbers at a time.
//!
//! Plain arrays, which compilers turn into vector instructions: `with_best_instructions` lets them use AVX2 where the processor has it.
//! Products and sums are never fused, so every processor finds the same bits.

/// How many numbers.
pub(super) const LANES: usize = 8;

/// Eight numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(super) struct Lanes(pub(super) [f32; LANES]);

impl Lanes {
    #[inline(always)]
    pub(super) fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    /// The lesser of each two.
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// The greater of each two.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// Bit `i`: whether lane `i` is greater than that of `other`.
    #[inline(always)]
    pub(super) fn greater(self, other: Self) -> u8 {
        let mut bits = 0;
        for i in 0..LANES {
            bits |= u8::from(self.0[i] > other.0[i]) << i;
        }
        bits
    }

    /// The least of all eight.
    #[inline(always)]
    pub(super) fn least(self) -> f32 {
        self.0.iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// The greatest of all eight.
    #[inline(always)]
    pub(super) fn greatest(self) -> f32 {
        self.0.iter().copied().fold(f32::NEG_INFINITY, f32::max)
    }
}

impl std::ops::Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl std::ops::Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl std::ops::Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

/// Eight points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Points(pub(super) [Lanes; 3]);

impl Points {
    /// `at(i)` for each lane.
    pub(super) fn from_fn(at: impl Fn(usize) -> [f32; 3]) -> Self {
        let points: [[f32; 3]; LANES] = std::array::from_fn(at);
        Self(std::array::from_fn(|axis| Lanes(points.map(|p| p[axis]))))
    }

    /// Each point less `origin`.
    #[inline(always)]
    pub(super) fn about(self, origin: [f32; 3]) -> Self {
        Self(std::array::from_fn(|axis| self.0[axis] - Lanes::splat(origin[axis])))
    }

    /// The product of each with `direction`.
    #[inline(always)]
    pub(super) fn dot(self, direction: [f32; 3]) -> Lanes {
        self.0[0] * Lanes::splat(direction[0])
            + self.0[1] * Lanes::splat(direction[1])
            + self.0[2] * Lanes::splat(direction[2])
    }
}

/// Calls `f`, compiled for AVX2 where the processor has it.
///
/// What `f` calls must be inlined into it to gain from that.
#[inline(always)]
pub(super) fn with_best_instructions<R>(f: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn with_avx2<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        if is_x86_feature_detected!("avx2") {
            #[expect(unsafe_code, reason = "the processor was asked")]
            // SAFETY: the processor has AVX2.
            return unsafe { with_avx2(f) };
        }
    }
    f()
}
