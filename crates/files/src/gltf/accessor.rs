//! Accessors: typed, strided, normalised and sparse numbers in buffers (glTF 2.0,
//! 3.6.2; integer types for any attribute as in KHR_mesh_quantization).
//!
//! An [`Accessor`] is checked once, when it is made; after that every element below
//! its count can be read, and nothing is copied. So a hundred primitives may share
//! one large accessor.

use super::buffers::{Buffers, pointer};
use super::component::Component;
use super::draco::Attribute;
use super::json;
use crate::FileError;

/// Elements at equal distances.
#[derive(Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: Component,
}

/// A checked accessor.
pub(super) struct Accessor<'a> {
    /// How many elements there are.
    pub count: usize,
    /// How many components an element has.
    pub width: usize,
    /// Its place, for messages.
    pub pointer: String,
    component: Component,
    /// `None`: all zeros.
    base: Option<Strided<'a>>,
    normalized: bool,
    /// Strictly increasing element numbers, and their values.
    replaced: Option<(usize, Strided<'a>, Strided<'a>)>,
}

impl<'a> Accessor<'a> {
    /// Accessor `index`, asked for at the pointer `from`, if its width is one of `widths`.
    pub fn new(
        buffers: &'a Buffers<'_>,
        index: usize,
        from: &str,
        widths: &[usize],
    ) -> Result<Self, FileError> {
        let Some(json) = buffers.document.accessors.get(index) else {
            return Err(buffers.missing(from, "accessor", index, buffers.document.accessors.len()));
        };
        let here = format!("/accessors/{index}");
        let context = buffers.context;
        let component = Component::of(json.component_type).ok_or_else(|| {
            let reason = format!("{} is no component type", json.component_type);
            context.invalid(pointer(format!("{here}/componentType")), reason)
        })?;
        let width = match json.kind.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => 0,
        };
        if !widths.contains(&width) {
            let reason = format!("{} elements do not fit {from}", json.kind);
            return Err(context.invalid(pointer(format!("{here}/type")), reason));
        }
        if json.count == 0 {
            return Err(
                context.invalid(pointer(format!("{here}/count")), "an accessor has at least one element")
            );
        }
        let layout = Layout { buffers, component, width, here: &here };
        let base = match json.buffer_view {
            Some(view) => Some(layout.strided(view, json.byte_offset, json.count, "")?),
            None => {
                // Nothing in the file bears out this count, so the limit has to.
                let limit = context.limits.max_vertices as u64;
                context.within(
                    pointer(format!("{here}/count")),
                    "elements without data",
                    json.count as u64,
                    limit,
                )?;
                None
            }
        };
        let replaced =
            json.sparse.as_ref().map(|sparse| layout.sparse(index, sparse, json.count)).transpose()?;
        let normalized = json.normalized;
        Ok(Self { count: json.count, width, component, base, normalized, replaced, pointer: here })
    }

    /// The values that a Draco stream has for accessor `index`, `count` of them.
    pub fn decoded(
        buffers: &'a Buffers<'_>,
        index: usize,
        from: &str,
        widths: &[usize],
        attribute: &'a Attribute,
        count: usize,
    ) -> Result<Self, FileError> {
        let Some(json) = buffers.document.accessors.get(index) else {
            return Err(buffers.missing(from, "accessor", index, buffers.document.accessors.len()));
        };
        let here = format!("/accessors/{index}");
        let (component, width) = (attribute.component, attribute.width);
        if !widths.contains(&width) {
            let reason = format!("the Draco stream's attribute of {width} components does not fit {from}");
            return Err(buffers.context.invalid(pointer(format!("{here}/type")), reason));
        }
        let stride = component.size() * width;
        let base = Some(Strided { bytes: &attribute.bytes, stride, component });
        // An accessor of floats says nothing about integers: then the stream's own word counts.
        let floats = Component::of(json.component_type) == Some(Component::F32);
        let normalized = if floats { attribute.normalized } else { json.normalized };
        Ok(Self { count, width, component, base, normalized, replaced: None, pointer: here })
    }

    /// Whether it may hold indices: whole numbers, one by one.
    pub fn is_index_like(&self) -> bool {
        self.width == 1 && matches!(self.component, Component::U8 | Component::U16 | Component::U32)
    }

    /// Where element `i` is.
    #[inline]
    fn find(&self, i: usize) -> Option<(&Strided<'a>, usize)> {
        if let Some((count, indices, values)) = &self.replaced {
            // Binary search: the indices increase.
            let (mut low, mut high) = (0, *count);
            while low < high {
                let middle = (low + high) / 2;
                match (indices.component.read_index(indices.bytes, middle * indices.stride) as usize).cmp(&i)
                {
                    std::cmp::Ordering::Equal => return Some((values, middle)),
                    std::cmp::Ordering::Less => low = middle + 1,
                    std::cmp::Ordering::Greater => high = middle,
                }
            }
        }
        self.base.as_ref().map(|base| (base, i))
    }

    /// Element `i`; components that the accessor does not have are taken from `rest`.
    #[inline]
    pub fn read<const N: usize>(&self, i: usize, rest: [f32; N]) -> [f32; N] {
        let mut out = rest;
        let found = self.find(i);
        for (c, value) in out.iter_mut().enumerate().take(self.width) {
            let raw =
                found.map_or(0.0, |(s, i)| s.component.read(s.bytes, i * s.stride + c * s.component.size()));
            *value = match found {
                Some((s, _)) if self.normalized => s.component.normalize(raw),
                _ => raw,
            };
        }
        out
    }

    /// Element `i` of an accessor that [is like indices](Self::is_index_like).
    #[inline]
    pub fn read_index(&self, i: usize) -> u32 {
        self.find(i).map_or(0, |(s, i)| s.component.read_index(s.bytes, i * s.stride))
    }
}

/// How an accessor's elements lie.
struct Layout<'a, 'd, 'p> {
    buffers: &'a Buffers<'d>,
    component: Component,
    width: usize,
    here: &'p str,
}

impl<'a> Layout<'a, '_, '_> {
    /// `count` elements of a buffer view from `offset`, all of them inside it.
    fn strided(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        part: &str,
    ) -> Result<Strided<'a>, FileError> {
        let here = format!("{}{part}", self.here);
        let (bytes, stride) = self.buffers.view(view, &format!("{here}/bufferView"))?;
        let invalid = |reason: String| self.buffers.context.invalid(pointer(here.clone()), reason);
        let size = self.component.size() * self.width;
        let stride = stride.filter(|_| part.is_empty()).unwrap_or(size);
        if stride < size {
            return Err(invalid(format!("elements of {size} bytes overlap at a stride of {stride}")));
        }
        let needed = (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
        let needed = needed.and_then(|n| n.checked_add(offset));
        match needed {
            Some(needed) if needed <= bytes.len() => {
                Ok(Strided { bytes: &bytes[offset..], stride, component: self.component })
            }
            _ => Err(invalid(format!(
                "{count} elements from byte {offset} reach beyond the {} bytes of buffer view {view}",
                bytes.len()
            ))),
        }
    }

    fn sparse(
        &self,
        index: usize,
        sparse: &json::Sparse,
        count: usize,
    ) -> Result<(usize, Strided<'a>, Strided<'a>), FileError> {
        let context = self.buffers.context;
        let place = |part: &str| pointer(format!("{}/sparse{part}", self.here));
        if sparse.count == 0 || sparse.count > count {
            let reason = format!("{} of {count} elements cannot be replaced", sparse.count);
            return Err(context.invalid(place("/count"), reason));
        }
        let component = match Component::of(sparse.indices.component_type) {
            Some(c @ (Component::U8 | Component::U16 | Component::U32)) => c,
            _ => {
                return Err(context.invalid(place("/indices/componentType"), "indices are unsigned integers"));
            }
        };
        let layout = Layout { component, width: 1, ..*self };
        let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset);
        let indices = layout.strided(view, offset, sparse.count, "/sparse/indices")?;
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset);
        let values = self.strided(view, offset, sparse.count, "/sparse/values")?;
        if self.buffers.ordered.borrow().contains(&index) {
            return Ok((sparse.count, indices, values));
        }
        let mut last = None;
        for i in 0..sparse.count {
            let element = component.read_index(indices.bytes, i * indices.stride) as usize;
            if element >= count || last.is_some_and(|last| element <= last) {
                let reason = format!("sparse index {element} (number {i}) is out of range or out of order");
                return Err(context.invalid(place("/indices"), reason));
            }
            last = Some(element);
        }
        self.buffers.ordered.borrow_mut().insert(index);
        Ok((sparse.count, indices, values))
    }
}
