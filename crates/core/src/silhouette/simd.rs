//! What is done to many planes, boxes or edges at once: with AVX2 where the processor has it, else in plain Rust.
//!
//! Both do the same operations in the same order and give the same bits; a test says so. AVX2 is asked for when it runs, so one program serves all
//! processors. The only unsafe code of this crate is here: calls of functions that need AVX2, each behind the question
//! whether it is there, and a hint to fetch memory.
//!
//! Gathers are not used: for the scan's table they took longer than plain loads.

use super::faces::WORD;
use super::packets::{Packet, PacketHits};

/// Children of a node of a tree.
pub(super) const CHILDREN: usize = 16;

/// The coefficient of each plane: 1 where the light is above it; else 0, or with `edge_on`, the least height that counts, -1 where it is below.
///
/// There are as many planes as coefficients, a multiple of [`WORD`].
pub(super) fn coefficients(planes: [&[f32]; 4], light: [f32; 4], edge_on: Option<f32>, coefficients: &mut [i8]) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the processor was asked")]
        // SAFETY: the processor has AVX2.
        return unsafe { avx2::coefficients(planes, light, edge_on, coefficients) };
    }
    plain::coefficients(planes, light, edge_on, coefficients);
}

/// For boxes given by the corners that the light is least and most above: which it is above all of, and which it is above nothing of; bit `i` for box `i`.
///
/// With `edge_on` it is above what is more than that below it, and below what is more than that above.
pub(super) fn sides(
    lowest: [&[f32; CHILDREN]; 4],
    highest: [&[f32; CHILDREN]; 4],
    light: [f32; 4],
    edge_on: Option<f32>,
) -> [u16; 2] {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the processor was asked")]
        // SAFETY: the processor has AVX2.
        return unsafe { avx2::sides(lowest, highest, light, edge_on) };
    }
    plain::sides(lowest, highest, light, edge_on)
}

/// Which edges of a packet are silhouette; `threshold` is `None` in closed components.
pub(super) fn hits(packet: &Packet, light: [f32; 4], threshold: Option<f32>) -> PacketHits {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the processor was asked")]
        // SAFETY: the processor has AVX2.
        return unsafe { avx2::hits(packet, light, threshold) };
    }
    plain::hits(packet, light, threshold)
}

/// Asks the processor to fetch `packet`, which will be wanted soon.
pub(super) fn prefetch(packet: &Packet) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        const LINE: usize = 64;
        let start = std::ptr::from_ref(packet).cast::<i8>();
        for line in 0..size_of::<Packet>() / LINE {
            #[expect(unsafe_code, reason = "a hint about memory that is there")]
            // SAFETY: the address is within the packet.
            unsafe {
                _mm_prefetch::<_MM_HINT_T0>(start.add(line * LINE));
            }
        }
    }
}

/// For any processor.
pub(super) mod plain {
    use super::super::faces::height;
    use super::super::packets::PLANES_AT_ONCE;
    use super::{CHILDREN, Packet, PacketHits, WORD};

    pub(in super::super) fn coefficients(
        planes: [&[f32]; 4],
        light: [f32; 4],
        edge_on: Option<f32>,
        coefficients: &mut [i8],
    ) {
        let limit = edge_on.unwrap_or(0.0);
        for (i, c) in coefficients.iter_mut().enumerate() {
            let h = height(planes.map(|axis| axis[i]), light);
            *c = i8::from(h > limit) - i8::from(edge_on.is_some() && h < -limit);
        }
    }

    pub(in super::super) fn sides(
        lowest: [&[f32; CHILDREN]; 4],
        highest: [&[f32; CHILDREN]; 4],
        light: [f32; 4],
        edge_on: Option<f32>,
    ) -> [u16; 2] {
        let [mut above, mut below] = [0; 2];
        let limit = edge_on.unwrap_or(0.0);
        for i in 0..CHILDREN {
            let least = height(lowest.map(|axis| axis[i]), light);
            let most = height(highest.map(|axis| axis[i]), light);
            above |= u16::from(least > limit) << i;
            below |= u16::from(most < -limit || (edge_on.is_none() && most <= 0.0)) << i;
        }
        [above, below]
    }

    pub(in super::super) fn hits(packet: &Packet, light: [f32; 4], threshold: Option<f32>) -> PacketHits {
        let limit = threshold.unwrap_or(0.0);
        let [mut up, mut down] = [0_u64; 2];
        for (i, planes) in packet.planes[..packet.group_count as usize].iter().enumerate() {
            for j in 0..PLANES_AT_ONCE {
                let h = height(planes.map(|axis| axis[j]), light);
                up |= u64::from(h > limit) << (i * PLANES_AT_ONCE + j);
                down |= u64::from(h < -limit) << (i * PLANES_AT_ONCE + j);
            }
        }
        let at = |bits: u64, indices: [u8; WORD]| {
            indices.iter().enumerate().fold(0, |all, (i, &plane)| all | (bits >> plane & 1) << i)
        };
        let [up_first, up_second] = [packet.first, packet.second].map(|indices| at(up, indices));
        if threshold.is_none() {
            return PacketHits { silhouette: up_first ^ up_second, forward: up_first, double: 0 };
        }
        let down = [packet.first, packet.second].map(|indices| at(down, indices));
        PacketHits::of_turns([up_first, up_second], down)
    }
}

/// With 256 bits at a time.
#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::*;

    use super::super::packets::PLANES_AT_ONCE;
    use super::{CHILDREN, Packet, PacketHits, WORD};

    #[target_feature(enable = "avx2")]
    fn eight(at: &[f32; PLANES_AT_ONCE]) -> __m256 {
        bytemuck::cast(*at)
    }

    /// As [`super::super::faces::height`]: the same operations in the same order.
    #[target_feature(enable = "avx2")]
    fn height([nx, ny, nz, nd]: [__m256; 4], [x, y, z, w]: [__m256; 4]) -> __m256 {
        let xy = _mm256_add_ps(_mm256_mul_ps(nx, x), _mm256_mul_ps(ny, y));
        _mm256_add_ps(_mm256_add_ps(xy, _mm256_mul_ps(nz, z)), _mm256_mul_ps(nd, w))
    }

    #[target_feature(enable = "avx2")]
    fn everywhere(light: [f32; 4]) -> [__m256; 4] {
        [_mm256_set1_ps(light[0]), _mm256_set1_ps(light[1]), _mm256_set1_ps(light[2]), _mm256_set1_ps(light[3])]
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn coefficients(planes: [&[f32]; 4], light: [f32; 4], edge_on: Option<f32>, coefficients: &mut [i8]) {
        const AT_ONCE: usize = 4 * PLANES_AT_ONCE;
        let light = everywhere(light);
        let high = _mm256_set1_ps(edge_on.unwrap_or(0.0));
        // Nothing is below minus infinity.
        let low = _mm256_set1_ps(edge_on.map_or(f32::NEG_INFINITY, |edge_on| -edge_on));
        let in_order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
        let [nx, ny, nz, nd] = planes.map(|axis| axis.as_chunks::<AT_ONCE>().0);
        let all = coefficients.as_chunks_mut::<AT_ONCE>().0.iter_mut().zip(nx).zip(ny).zip(nz).zip(nd);
        for ((((c, nx), ny), nz), nd) in all {
            let [nx, ny, nz, nd] = [nx, ny, nz, nd].map(|axis| axis.as_chunks::<PLANES_AT_ONCE>().0);
            let eight_at = |i: usize| {
                let h = height([eight(&nx[i]), eight(&ny[i]), eight(&nz[i]), eight(&nd[i])], light);
                // A comparison that holds is -1.
                let is_above = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(h, high));
                let is_below = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(h, low));
                _mm256_sub_epi32(is_below, is_above)
            };
            let words = _mm256_packs_epi32(eight_at(0), eight_at(1));
            let more = _mm256_packs_epi32(eight_at(2), eight_at(3));
            *c = bytemuck::cast(_mm256_permutevar8x32_epi32(_mm256_packs_epi16(words, more), in_order));
        }
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn sides(
        lowest: [&[f32; CHILDREN]; 4],
        highest: [&[f32; CHILDREN]; 4],
        light: [f32; 4],
        edge_on: Option<f32>,
    ) -> [u16; 2] {
        let light = everywhere(light);
        let limit = edge_on.unwrap_or(0.0);
        let [mut above, mut below] = [0; 2];
        for half in 0..CHILDREN / PLANES_AT_ONCE {
            let of_half = |axis: &[f32; CHILDREN]| eight(&axis.as_chunks().0[half]);
            let least = height([of_half(lowest[0]), of_half(lowest[1]), of_half(lowest[2]), of_half(lowest[3])], light);
            let most =
                height([of_half(highest[0]), of_half(highest[1]), of_half(highest[2]), of_half(highest[3])], light);
            let is_above = _mm256_cmp_ps::<_CMP_GT_OQ>(least, _mm256_set1_ps(limit));
            let is_below = match edge_on {
                Some(edge_on) => _mm256_cmp_ps::<_CMP_LT_OQ>(most, _mm256_set1_ps(-edge_on)),
                None => _mm256_cmp_ps::<_CMP_LE_OQ>(most, _mm256_setzero_ps()),
            };
            above |= (_mm256_movemask_ps(is_above) as u16) << (PLANES_AT_ONCE * half);
            below |= (_mm256_movemask_ps(is_below) as u16) << (PLANES_AT_ONCE * half);
        }
        [above, below]
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn hits(packet: &Packet, light: [f32; 4], threshold: Option<f32>) -> PacketHits {
        let light = everywhere(light);
        let (first, second) = (Bytes::new(&packet.first), Bytes::new(&packet.second));
        let turned = |threshold: f32, sign: f32| {
            let (threshold, sign) = (_mm256_set1_ps(threshold), _mm256_set1_ps(sign));
            let mut is_turned = [_mm256_setzero_si256(); WORD / PLANES_AT_ONCE];
            for (is_turned, planes) in is_turned.iter_mut().zip(&packet.planes[..packet.group_count as usize]) {
                let h = height([eight(&planes[0]), eight(&planes[1]), eight(&planes[2]), eight(&planes[3])], light);
                let h = _mm256_xor_ps(h, sign);
                *is_turned = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(h, threshold));
            }
            let is_turned = Table::new(is_turned);
            [is_turned.at(first), is_turned.at(second)]
        };
        let Some(threshold) = threshold else {
            let [first, second] = turned(0.0, 0.0);
            return PacketHits { silhouette: first ^ second, forward: first, double: 0 };
        };
        PacketHits::of_turns(turned(threshold, 0.0), turned(threshold, -0.0))
    }

    /// 64 bytes.
    #[derive(Clone, Copy)]
    struct Bytes([__m256i; 2]);

    impl Bytes {
        #[target_feature(enable = "avx2")]
        fn new(bytes: &[u8; WORD]) -> Self {
            Self(bytemuck::cast(*bytes))
        }
    }

    /// One bit for each of 64 planes, to be looked up by number: four parts of 16, each in both halves of a register, as shuffles want them.
    struct Table([__m256i; 4]);

    impl Table {
        /// Of comparisons of eight planes each, all bits set or none.
        #[target_feature(enable = "avx2")]
        fn new(octets: [__m256i; WORD / PLANES_AT_ONCE]) -> Self {
            let in_order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
            let half = |i: usize| {
                let words = _mm256_packs_epi32(octets[i], octets[i + 1]);
                let more = _mm256_packs_epi32(octets[i + 2], octets[i + 3]);
                _mm256_permutevar8x32_epi32(_mm256_packs_epi16(words, more), in_order)
            };
            let (low, high) = (half(0), half(4));
            Self([
                _mm256_permute2x128_si256::<0x00>(low, low),
                _mm256_permute2x128_si256::<0x11>(low, low),
                _mm256_permute2x128_si256::<0x00>(high, high),
                _mm256_permute2x128_si256::<0x11>(high, high),
            ])
        }

        /// Bit `i` is that of plane `indices[i]`.
        #[target_feature(enable = "avx2")]
        fn at(&self, indices: Bytes) -> u64 {
            let [low, high] = indices.0.map(|indices| self.at_half(indices));
            u64::from(low) | u64::from(high) << 32
        }

        #[target_feature(enable = "avx2")]
        fn at_half(&self, indices: __m256i) -> u32 {
            // A blend looks at the top bit of each byte: bits 4 and 5 are moved there.
            let (bit_4, bit_5) = (_mm256_slli_epi16::<3>(indices), _mm256_slli_epi16::<2>(indices));
            let [a, b, c, d] = self.0.map(|part| _mm256_shuffle_epi8(part, indices));
            let (low, high) = (_mm256_blendv_epi8(a, b, bit_4), _mm256_blendv_epi8(c, d, bit_4));
            _mm256_movemask_epi8(_mm256_blendv_epi8(low, high, bit_5)) as u32
        }
    }
}
