//! Eight numbers at a time.
//!
//! Plain arrays in plain loops, which compilers turn into vector instructions: of AVX2, in a function compiled for it into which all of this is
//! inlined. (Closures and `array::from_fn` are functions of their own and would not be.) Products and sums are never fused, so every processor finds the
//! same bits.

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

    /// The lesser of each two.
    #[inline(always)]
    pub(super) fn min(mut self, other: Self) -> Self {
        for i in 0..LANES {
            self.0[i] = if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] };
        }
        self
    }

    /// The greater of each two.
    #[inline(always)]
    pub(super) fn max(mut self, other: Self) -> Self {
        for i in 0..LANES {
            self.0[i] = if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] };
        }
        self
    }

    /// Each without its sign.
    #[inline(always)]
    pub(super) fn abs(mut self) -> Self {
        for i in 0..LANES {
            self.0[i] = self.0[i].abs();
        }
        self
    }

    /// Bit `i`: whether lane `i` is greater than that of `other`.
    #[inline(always)]
    pub(super) fn greater(self, other: Self) -> u8 {
        // Compilers make many instructions of a loop over bits, so this one is spelled out.
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_mm_cmpgt_ps, _mm_movemask_ps, _mm_setr_ps};
            let ([a, b, c, d, e, f, g, h], [i, j, k, l, m, n, o, p]) = (self.0, other.0);
            #[expect(unsafe_code, reason = "every x86-64 processor has SSE")]
            // SAFETY: as the reason says; no memory is touched.
            let [low, high] = unsafe {
                [
                    _mm_movemask_ps(_mm_cmpgt_ps(_mm_setr_ps(a, b, c, d), _mm_setr_ps(i, j, k, l))),
                    _mm_movemask_ps(_mm_cmpgt_ps(_mm_setr_ps(e, f, g, h), _mm_setr_ps(m, n, o, p))),
                ]
            };
            (low | high << 4) as u8
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            let mut bits = 0;
            for i in 0..LANES {
                bits |= u8::from(self.0[i] > other.0[i]) << i;
            }
            bits
        }
    }

    /// Lane by lane, `yes` where this is greater than `than`, else `no`.
    #[inline(always)]
    pub(super) fn select_greater(self, than: Self, yes: Self, mut no: Self) -> Self {
        for i in 0..LANES {
            no.0[i] = if self.0[i] > than.0[i] { yes.0[i] } else { no.0[i] };
        }
        no
    }

    /// The least of all eight.
    #[inline(always)]
    pub(super) fn least(self) -> f32 {
        let mut least = self.0[0];
        for i in 1..LANES {
            least = if self.0[i] < least { self.0[i] } else { least };
        }
        least
    }

    /// The greatest of all eight.
    #[inline(always)]
    pub(super) fn greatest(self) -> f32 {
        let mut greatest = self.0[0];
        for i in 1..LANES {
            greatest = if self.0[i] > greatest { self.0[i] } else { greatest };
        }
        greatest
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $operator:tt) => {
        impl std::ops::$trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(mut self, other: Self) -> Self {
                for i in 0..LANES {
                    self.0[i] $operator other.0[i];
                }
                self
            }
        }
    };
}
operator!(Add, add, +=);
operator!(Sub, sub, -=);
operator!(Mul, mul, *=);
operator!(Div, div, /=);

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
        let [x, y, z] = self.0;
        Self([x - Lanes::splat(origin[0]), y - Lanes::splat(origin[1]), z - Lanes::splat(origin[2])])
    }

    /// The product of each with `direction`.
    #[inline(always)]
    pub(super) fn dot(self, direction: [f32; 3]) -> Lanes {
        self.0[0] * Lanes::splat(direction[0])
            + self.0[1] * Lanes::splat(direction[1])
            + self.0[2] * Lanes::splat(direction[2])
    }
}
