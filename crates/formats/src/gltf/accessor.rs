//! The numbers behind accessors, every range checked before it is read.

use super::budget::Budget;
use super::container::Buffers;
use super::document::{Accessor, BufferView, Document};
use crate::error::quoted;

/// Reads accessors. What is wrong is said in words that fit after "mesh 3: ".
#[derive(Debug)]
pub(super) struct Accessors<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    budget: Budget,
    file_bytes: usize,
}

/// How one number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of_code(code: u32) -> Result<Self, String> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(format!("its component type {code} does not exist")),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The largest value, which a normalised integer stands for 1 with.
    fn largest(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 => 1.0,
        }
    }

    /// The value in the first [`Component::size`] of `bytes`.
    fn value(self, bytes: [u8; 4]) -> f64 {
        let [a, b, ..] = bytes;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::U32 => f64::from(u32::from_le_bytes(bytes)),
            Self::F32 => f64::from(f32::from_le_bytes(bytes)),
        }
    }
}

/// Elements of `width` numbers, `stride` bytes apart, all inside `bytes`.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: Component,
    width: usize,
}

impl Elements<'_> {
    fn read(&self, index: usize, values: &mut [f64]) {
        let size = self.component.size();
        let start = index * self.stride;
        for (value, stored) in values.iter_mut().zip(self.bytes[start..][..size * self.width].chunks_exact(size)) {
            let mut padded = [0; 4];
            padded[..size].copy_from_slice(stored);
            *value = self.component.value(padded);
        }
    }
}

impl<'a> Accessors<'a> {
    /// `file_bytes` is the size of the file itself.
    pub(super) fn new(document: &'a Document, buffers: Buffers<'a>, file_bytes: usize) -> Self {
        let file_bytes = file_bytes.saturating_add(buffers.external_bytes());
        Self { document, buffers, budget: Budget::new(file_bytes), file_bytes }
    }

    /// The size of the file, its external buffers included.
    pub(super) fn file_bytes(&self) -> usize {
        self.file_bytes
    }

    /// Charges the file for what is made of its numbers, see [`Budget`].
    pub(super) fn charge(&self, count: usize, width: usize) -> Result<(), String> {
        self.budget.charge(count, width)
    }

    /// Vectors or matrices of `N` numbers: floats as they are, normalised integers as -1 or 0 to 1, others by value.
    pub(super) fn vectors<const N: usize>(&self, index: usize) -> Result<Vec<[f64; N]>, String> {
        let accessor = self.get(index)?;
        let component = Component::of_code(accessor.component_type).map_err(|e| format!("accessor {index}: {e}"))?;
        self.elements(index, shape_of_width(N), |stored: [f64; N]| {
            // The least signed integer stands for -1 too.
            stored.map(|value| if accessor.normalized { (value / component.largest()).max(-1.0) } else { value })
        })
    }

    /// Colours of three or four channels, the fourth left out.
    pub(super) fn colors(&self, index: usize) -> Result<Vec<[f64; 3]>, String> {
        match self.get(index)?.shape.as_str() {
            "VEC4" => Ok(self.vectors(index)?.into_iter().map(|[r, g, b, _]: [f64; 4]| [r, g, b]).collect()),
            _ => self.vectors(index),
        }
    }

    /// Unsigned integers.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, String> {
        let code = self.get(index)?.component_type;
        if !matches!(Component::of_code(code), Ok(Component::U8 | Component::U16 | Component::U32)) {
            return Err(format!("accessor {index}: indices can't have component type {code}"));
        }
        self.elements(index, "SCALAR", |[stored]: [f64; 1]| stored as u32)
    }

    fn get(&self, index: usize) -> Result<&'a Accessor, String> {
        let accessors = &self.document.accessors;
        accessors.get(index).ok_or_else(|| format!("there is no accessor {index}, only {}", accessors.len()))
    }

    fn elements<const N: usize, T: Clone>(
        &self,
        index: usize,
        shape: &str,
        convert: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, String> {
        let accessor = self.get(index)?;
        self.checked_elements(accessor, shape, convert).map_err(|message| format!("accessor {index}: {message}"))
    }

    fn checked_elements<const N: usize, T: Clone>(
        &self,
        accessor: &Accessor,
        shape: &str,
        convert: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, String> {
        if accessor.shape != shape {
            return Err(format!("it is {} where {shape} is needed", quoted(&accessor.shape)));
        }
        let component = Component::of_code(accessor.component_type)?;
        self.budget.charge(accessor.count, N)?;
        let mut buffer = [0.0; N];
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let stored = self.stored(view, accessor.byte_offset, accessor.count, component, N)?;
                (0..accessor.count)
                    .map(|i| {
                        stored.read(i, &mut buffer);
                        convert(buffer)
                    })
                    .collect()
            }
            None => vec![convert(buffer); accessor.count],
        };
        let Some(sparse) = &accessor.sparse else { return Ok(elements) };
        self.budget.charge(sparse.count, N + 1)?;
        let places = &sparse.indices;
        let place_component = Component::of_code(places.component_type)?;
        let places = self.stored(places.buffer_view, places.byte_offset, sparse.count, place_component, 1)?;
        let values = self.stored(sparse.values.buffer_view, sparse.values.byte_offset, sparse.count, component, N)?;
        for i in 0..sparse.count {
            let mut place = [0.0];
            places.read(i, &mut place);
            values.read(i, &mut buffer);
            *elements
                .get_mut(place[0] as usize)
                .ok_or_else(|| format!("its sparse value {i} is for element {} of {}", place[0], accessor.count))? =
                convert(buffer);
        }
        Ok(elements)
    }

    /// The bytes of a buffer view.
    pub(super) fn view_bytes(&self, view_index: usize) -> Result<&[u8], String> {
        self.view(view_index).map(|(_, bytes)| bytes)
    }

    fn view(&self, view_index: usize) -> Result<(&BufferView, &[u8]), String> {
        let views = &self.document.buffer_views;
        let view: &BufferView = views
            .get(view_index)
            .ok_or_else(|| format!("there is no buffer view {view_index}, only {}", views.len()))?;
        let buffer = self.buffers.get(view.buffer)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end)).ok_or_else(|| {
            format!(
                "buffer view {view_index} is {} bytes from byte {}, but buffer {} has {}",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                buffer.len()
            )
        })?;
        Ok((view, bytes))
    }

    /// `count` elements in a buffer view.
    fn stored(
        &self,
        view_index: usize,
        byte_offset: usize,
        count: usize,
        component: Component,
        width: usize,
    ) -> Result<Elements<'_>, String> {
        let (view, bytes) = self.view(view_index)?;
        let element_bytes = component.size() * width;
        let stride = view.byte_stride.unwrap_or(element_bytes);
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(element_bytes)),
        };
        let end = needed.and_then(|needed| needed.checked_add(byte_offset));
        let bytes = end.and_then(|end| bytes.get(byte_offset..end)).ok_or_else(|| {
            format!(
                "its {count} elements of {element_bytes} bytes, {stride} apart from byte {byte_offset}, reach beyond the {} \
                 bytes of buffer view {view_index}",
                bytes.len()
            )
        })?;
        Ok(Elements { bytes, stride, component, width })
    }
}

fn shape_of_width(width: usize) -> &'static str {
    match width {
        2 => "VEC2",
        3 => "VEC3",
        4 => "VEC4",
        16 => "MAT4",
        _ => "SCALAR",
    }
}
