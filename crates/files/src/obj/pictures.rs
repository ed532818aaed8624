//! The pictures that the materials of an OBJ file name: where they are, and which material uses them how.
//!
//! Contract: each picture is read once. One that is not there is a warning.

use super::find_file::{found, read_absolute, read_beside};
use super::mtl::Map;
use crate::context::{Context, NamedBytes, Textures};
use crate::search::is_absolute;
use crate::{FileError, WarningKind};
use parbake_model::glam::Vec2;
use parbake_model::{TextureSlot, UvTransform, Wrap};
use std::collections::HashMap;

/// Pictures found so far, each once, to be decoded together.
pub(super) struct Pictures<'a, 'c> {
    pub context: &'a Context<'c>,
    pub found: Vec<NamedBytes<'static>>,
    /// By path as tried. `None`: not found.
    seen: HashMap<String, Option<usize>>,
}

impl<'a, 'c> Pictures<'a, 'c> {
    /// None yet.
    pub fn new(context: &'a Context<'c>) -> Self {
        Self { context, found: Vec::new(), seen: HashMap::new() }
    }

    /// The material's use of the picture, if it can be found; else a warning that names both.
    pub fn slot(
        &mut self,
        map: &Map,
        folder: &str,
        material: &str,
    ) -> Result<Option<TextureSlot>, FileError> {
        if self.context.textures == Textures::Skip {
            return Ok(None);
        }
        let key = format!("{folder}{}", map.file);
        let image = match self.seen.get(&key) {
            Some(&known) => known,
            None => {
                let image = self.load(&key, map, folder)?;
                self.seen.insert(key, image);
                image
            }
        };
        let Some(image) = image else {
            let name = &map.file;
            self.context.warn_of(
                WarningKind::MissingTexture,
                format!(
                    "material {material:?}: picture {name:?} was not found; the material goes without it"
                ),
            );
            return Ok(None);
        };
        let wrap = [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2];
        Ok(Some(TextureSlot { image, uv_set: 0, wrap, transform: transform(map) }))
    }

    fn load(&mut self, key: &str, map: &Map, folder: &str) -> Result<Option<usize>, FileError> {
        let found = if is_absolute(&map.file) {
            read_absolute(&map.file, folder, self.context)?
        } else {
            let mut places = vec![key];
            // Some libraries name pictures as the model sees them. With confinement, what leads out of
            // the library's folder may stay in the model's, and the other way round.
            if !folder.is_empty() {
                places.push(&map.file);
            }
            let mut found = None;
            for place in places {
                found = read_beside(place, self.context)?.map(|bytes| (place.to_string(), bytes));
                if found.is_some() {
                    break;
                }
            }
            match found {
                Some(found) => Some(found),
                // Many libraries carry the paths of the machine they were written on.
                None => {
                    let most = self.context.limits.max_file_bytes;
                    let read = self.context.read_by_name(&map.file, folder, most);
                    self::found(read, &map.file, self.context)?.flatten()
                }
            }
        };
        Ok(found.map(|(place, bytes)| {
            self.found.push((place, bytes.into()));
            self.found.len() - 1
        }))
    }
}

/// `v_up' = s·v_up + o` becomes, v down, `v' = s·v + (1 − s − o)`.
fn transform(map: &Map) -> UvTransform {
    let ([su, sv], [ou, ov]) = (map.scale, map.offset);
    UvTransform { offset: Vec2::new(ou, 1.0 - sv - ov), rotation: 0.0, scale: Vec2::new(su, sv) }
}
