//! Textures, samplers and images (glTF 2.0, 3.8), with KHR_texture_transform,
//! EXT_texture_webp and KHR_texture_basisu.
//!
//! Images are decoded once each, and only those that a material uses. An image that is not there
//! is a warning; one that cannot be decoded is an error.

use super::buffers::{Buffers, pointer};
use super::json;
use super::json_texture::{TextureInfo, TextureTransform};
use super::uri::{Uri, parse};
use super::uv_sets::{self, UvSets};
use crate::context::{NamedBytes, Textures};
use crate::image_in::Origin;
use crate::{FileError, WarningKind};
use parbake_model::glam::Vec2;
use parbake_model::{Image, TextureSlot, UvTransform, Wrap};
use std::collections::HashMap;

/// Finds what textures refer to, and remembers the images until all are known.
pub(super) struct TextureReader<'a, 'd> {
    pub buffers: &'a Buffers<'d>,
    /// Those of the material whose textures are asked for.
    pub uv_sets: UvSets,
    /// Those in use, to be decoded at the end.
    pictures: Vec<NamedBytes<'a>>,
    /// From the document's images to ours; `None` where one could not be found.
    places: HashMap<usize, Option<usize>>,
}

impl<'a, 'd> TextureReader<'a, 'd> {
    pub fn new(buffers: &'a Buffers<'d>) -> Self {
        Self { buffers, uv_sets: UvSets::default(), pictures: Vec::new(), places: HashMap::new() }
    }

    /// The images of all slots so far, in their order.
    pub fn decode(&self) -> Result<Vec<Image>, FileError> {
        self.buffers.context.decode_images(&self.pictures, Origin::Gltf)
    }

    /// One use of a texture; `None`, with a warning, when its picture cannot be found.
    pub fn slot(&mut self, info: &TextureInfo, here: &str) -> Result<Option<TextureSlot>, FileError> {
        let (buffers, document) = (self.buffers, self.buffers.document);
        if buffers.context.textures == Textures::Skip {
            return Ok(None);
        }
        let Some(texture) = document.textures.get(info.index) else {
            return Err(buffers.missing(
                &format!("{here}/index"),
                "texture",
                info.index,
                document.textures.len(),
            ));
        };
        let wrap = match texture.sampler {
            None => [Wrap::Repeat; 2],
            Some(index) => {
                let sampler = document.samplers.get(index).ok_or_else(|| {
                    let from = format!("/textures/{}/sampler", info.index);
                    buffers.missing(&from, "sampler", index, document.samplers.len())
                })?;
                [wrap(sampler.wrap_s), wrap(sampler.wrap_t)]
            }
        };
        let transform = info.extensions.transform.as_ref();
        let set = uv_sets::set(info);
        let Some(uv_set) = self.uv_sets.place(set) else {
            buffers.context.warn(format!(
                "{here}: {} has textures of more than two sets of coordinates; this one, of set {set}, was left out",
                named(document, here)
            ));
            return Ok(None);
        };
        // Several sources may be given: a PNG or JPEG needs no extension, and loses least.
        let extensions = &texture.extensions;
        let source_of = |extension: &Option<json::TextureSource>| extension.as_ref().and_then(|e| e.source);
        let source = texture.source.or(source_of(&extensions.webp)).or(source_of(&extensions.basisu));
        let Some(source) = source else {
            let index = info.index;
            buffers.context.warn_of(
                WarningKind::MissingTexture,
                format!("texture {index} has no image that can be read; {here} goes without it"),
            );
            return Ok(None);
        };
        let Some(image) = self.image(source, &format!("/textures/{}/source", info.index))? else {
            // Its file was named when it was looked for; here the material that misses it is.
            buffers.context.warn_of(
                WarningKind::MissingTexture,
                format!("{here}: its picture is missing; {} goes without it", named(document, here)),
            );
            return Ok(None);
        };
        Ok(Some(TextureSlot {
            image,
            uv_set,
            wrap,
            transform: match transform {
                None => UvTransform::default(),
                Some(json) => uv_transform(json).ok_or_else(|| {
                    let place = pointer(format!("{here}/extensions/KHR_texture_transform"));
                    buffers.context.invalid(place, "the transform is not finite in single precision")
                })?,
            },
        }))
    }

    fn image(&mut self, index: usize, from: &str) -> Result<Option<usize>, FileError> {
        let Some(json) = self.buffers.document.images.get(index) else {
            return Err(self.buffers.missing(from, "image", index, self.buffers.document.images.len()));
        };
        if let Some(&place) = self.places.get(&index) {
            return Ok(place);
        }
        let place = self.fetch(index, json)?.map(|picture| {
            self.pictures.push(picture);
            self.pictures.len() - 1
        });
        self.places.insert(index, place);
        Ok(place)
    }

    /// `None`, with a warning, when the image's file cannot be found.
    fn fetch(&self, index: usize, json: &json::Image) -> Result<Option<NamedBytes<'a>>, FileError> {
        let context = self.buffers.context;
        let here = format!("/images/{index}");
        let data_uri = |uri: &str| uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:"));
        let name = match &json.uri {
            _ if !json.name.is_empty() => json.name.clone(),
            Some(uri) if !data_uri(uri) => uri.clone(),
            _ => format!("image {index}"),
        };
        if let Some(view) = json.buffer_view {
            let (bytes, _) = self.buffers.view(view, &format!("{here}/bufferView"))?;
            return Ok(Some((name, bytes.into())));
        }
        let Some(uri) = &json.uri else {
            return Err(context.invalid(pointer(here), "the image has neither a URI nor a buffer view"));
        };
        let bytes = match parse(uri) {
            Ok(Uri::Data(bytes)) => bytes,
            Ok(Uri::Relative(path)) => match self.buffers.external(&path, pointer(format!("{here}/uri")))? {
                Ok(bytes) => bytes,
                Err(FileError::Read { source, .. }) => {
                    context.warn_of(
                        WarningKind::MissingTexture,
                        format!("image {source}; the material goes without it"),
                    );
                    return Ok(None);
                }
                Err(other) => return Err(other),
            },
            // A damaged data URI is a damaged image; an address is one that is not there.
            Err(reason) if data_uri(uri) => {
                return Err(context.invalid(pointer(format!("{here}/uri")), reason));
            }
            Err(reason) => {
                context.warn_of(
                    WarningKind::MissingTexture,
                    format!("image {name:?}: {reason}; the material goes without it"),
                );
                return Ok(None);
            }
        };
        Ok(Some((name, bytes.into())))
    }
}

/// The material of a pointer "/materials/INDEX/…", by its name where it has one.
fn named(document: &json::Document, pointer: &str) -> String {
    let index = pointer.split('/').nth(2).and_then(|index| index.parse::<usize>().ok());
    match index.and_then(|index| document.materials.get(index)) {
        Some(material) if !material.name.is_empty() => format!("material {:?}", material.name),
        _ => "the material".into(),
    }
}

fn wrap(code: Option<usize>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

fn uv_transform(json: &TextureTransform) -> Option<UvTransform> {
    let (offset, scale) = (json.offset.unwrap_or([0.0; 2]), json.scale.unwrap_or([1.0; 2]));
    let (offset, scale) = (Vec2::from_array(offset), Vec2::from_array(scale));
    let finite = offset.is_finite() && scale.is_finite() && json.rotation.is_finite();
    finite.then_some(UvTransform { offset, rotation: json.rotation, scale })
}
