//! Eight numbers at a time: with AVX2 where the processor has it, else in plain Rust.
//!
//! Products and sums are never fused, so every processor finds the same bits. What is generic over [`Lanes`] must be inlined, all the way up to
//! [`OnLanes::run`], which is compiled for each; closures are not always, and then everything takes four times as long. All unsafe code of the engine is here.

/// How many numbers.
pub(super) const LANES: usize = 8;

/// Eight numbers in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(super) struct Eight(pub(super) [f32; LANES]);

impl Eight {
    pub(super) const ZERO: Self = Self([0.0; LANES]);

    /// The least of all eight.
    #[inline(always)]
    pub(super) fn least(&self) -> f32 {
        self.0.iter().copied().fold(f32::INFINITY, |least, x| if x < least { x } else { least })
    }

    /// The greatest of all eight.
    #[inline(always)]
    pub(super) fn greatest(&self) -> f32 {
        self.0.iter().copied().fold(f32::NEG_INFINITY, |greatest, x| if x > greatest { x } else { greatest })
    }
}

/// Eight points in memory, axis by axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Points(pub(super) [Eight; 3]);

impl Points {
    /// `at(i)` for each lane.
    pub(super) fn from_fn(at: impl Fn(usize) -> [f32; 3]) -> Self {
        let points: [[f32; 3]; LANES] = std::array::from_fn(at);
        Self(std::array::from_fn(|axis| Eight(points.map(|p| p[axis]))))
    }

    /// As they are.
    #[inline(always)]
    pub(super) fn load<L: Lanes>(&self) -> [L; 3] {
        [L::load(&self.0[0]), L::load(&self.0[1]), L::load(&self.0[2])]
    }

    /// Each point less `origin`.
    #[inline(always)]
    pub(super) fn about<L: Lanes>(&self, origin: [f32; 3]) -> [L; 3] {
        let [x, y, z] = self.load::<L>();
        [x.sub(L::splat(origin[0])), y.sub(L::splat(origin[1])), z.sub(L::splat(origin[2]))]
    }
}

/// The product of each of eight points with `direction`.
#[inline(always)]
pub(super) fn dot<L: Lanes>(points: &[L; 3], direction: [f32; 3]) -> L {
    let [x, y, z] = [
        points[0].mul(L::splat(direction[0])),
        points[1].mul(L::splat(direction[1])),
        points[2].mul(L::splat(direction[2])),
    ];
    x.add(y).add(z)
}

/// Eight numbers in a register, or as good as.
pub(super) trait Lanes: Copy {
    fn load(from: &Eight) -> Self;
    fn store(self, to: &mut Eight);
    fn splat(value: f32) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// `other` where that is less, else this.
    fn min(self, other: Self) -> Self;
    /// `other` where that is greater, else this.
    fn max(self, other: Self) -> Self;
    /// Without the sign.
    fn abs(self) -> Self;
    /// Bit `i`: whether lane `i` is greater than that of `other`.
    fn greater(self, other: Self) -> u8;
    /// `yes` where this is greater than `than`, else `no`.
    fn select_greater(self, than: Self, yes: Self, no: Self) -> Self;

    /// In memory.
    #[inline(always)]
    fn stored(self) -> Eight {
        let mut eight = Eight::ZERO;
        self.store(&mut eight);
        eight
    }
}

/// For any processor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plain(Eight);

impl Plain {
    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        for i in 0..LANES {
            self.0.0[i] = f(self.0.0[i], other.0.0[i]);
        }
        self
    }
}

impl Lanes for Plain {
    #[inline(always)]
    fn load(from: &Eight) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn store(self, to: &mut Eight) {
        *to = self.0;
    }

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(Eight([value; LANES]))
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if b < a { b } else { a })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if b > a { b } else { a })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.zip(self, |a, _| a.abs())
    }

    #[inline(always)]
    fn greater(self, other: Self) -> u8 {
        let mut bits = 0;
        for i in 0..LANES {
            bits |= u8::from(self.0.0[i] > other.0.0[i]) << i;
        }
        bits
    }

    #[inline(always)]
    fn select_greater(self, than: Self, yes: Self, mut no: Self) -> Self {
        for i in 0..LANES {
            no.0.0[i] = if self.0.0[i] > than.0.0[i] { yes.0.0[i] } else { no.0.0[i] };
        }
        no
    }
}

/// What is done eight numbers at a time.
pub(super) trait OnLanes {
    /// To be inlined.
    fn run<L: Lanes>(self);
}

/// Does `work` with the best that the processor has.
pub(super) fn on_best_lanes(work: impl OnLanes) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the processor was asked")]
        // SAFETY: the processor has AVX2.
        return unsafe { avx::run(work) };
    }
    work.run::<Plain>();
}

#[cfg(target_arch = "x86_64")]
#[expect(
    unsafe_code,
    reason = "only functions compiled for AVX2 name the type, and they are called where the processor has it"
)]
mod avx {
    use std::arch::x86_64::{
        __m256, _CMP_GT_OQ, _mm256_add_ps, _mm256_andnot_ps, _mm256_blendv_ps, _mm256_cmp_ps, _mm256_div_ps,
        _mm256_load_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps,
        _mm256_store_ps, _mm256_sub_ps,
    };

    use super::{Eight, Lanes, OnLanes};

    #[target_feature(enable = "avx2")]
    pub(super) fn run(work: impl OnLanes) {
        work.run::<Avx>();
    }

    /// To be named only by functions that are compiled for AVX2.
    #[derive(Debug, Clone, Copy)]
    struct Avx(__m256);

    // SAFETY, of all calls below: the processor has the instructions, as above; the two that touch memory are given an `Eight`, which is as large and as
    // aligned as they ask.
    impl Lanes for Avx {
        #[inline(always)]
        fn load(from: &Eight) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_load_ps(from.0.as_ptr()) })
        }

        #[inline(always)]
        fn store(self, to: &mut Eight) {
            // SAFETY: see above.
            unsafe { _mm256_store_ps(to.0.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn splat(value: f32) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_set1_ps(value) })
        }

        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_add_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_sub_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn div(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_div_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: see above. The instruction gives its second operand where they are equal.
            Self(unsafe { _mm256_min_ps(other.0, self.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_max_ps(other.0, self.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn greater(self, other: Self) -> u8 {
            // SAFETY: see above.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(self.0, other.0)) as u8 }
        }

        #[inline(always)]
        fn select_greater(self, than: Self, yes: Self, no: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_blendv_ps(no.0, yes.0, _mm256_cmp_ps::<_CMP_GT_OQ>(self.0, than.0)) })
        }
    }
}
