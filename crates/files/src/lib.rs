//! Parbake's doors: OBJ, glTF and pictures in, GLB, OBJ and PNG out.
//!
//! Readers turn any file into a [`Model`](parbake_model::Model) that keeps the
//! model's contract or into a [`FileError`] that names the file and the place;
//! they never panic and reserve no memory that a file only claims to need
//! ([`Limits`]). What is odd but can be lived with becomes a [`Warning`].

mod atomic;
mod contents;
mod context;
mod error;
mod finish;
mod gltf;
mod guard;
mod image_in;
mod image_out;
mod image_trouble;
mod ktx2;
mod ktx2_out;
mod limits;
mod loaded;
mod model_in;
mod model_out;
mod named_files;
mod normal_y;
mod obj;
mod picture_files;
mod replaced_files;
mod resources;
mod search;
mod self_contained;
mod texture_out;
mod unit;
mod warning;
mod words;
mod write_options;

pub use atomic::{write_atomically, write_streamed};
pub use contents::{Contents, PictureFormat, StoredPicture};
pub use error::{FileError, Place};
pub use gltf::{
    glb_bytes, glb_bytes_with, quick_glb_bytes, read_gltf_bytes, write_glb, write_glb_keeping,
    write_glb_with, write_lod_glb,
};
pub use image_in::{decode_image, read_image};
pub use image_out::{encode_png, encode_png16};
pub use limits::Limits;
pub use loaded::Loaded;
pub use model_in::{read_geometry, read_model, read_model_with_pictures, read_painted_model};
pub use named_files::named_files;
pub use normal_y::{NormalY, with_normal_y};
pub use obj::{read_obj_bytes, write_obj};
pub use picture_files::PictureFiles;
pub use replaced_files::replaced_files;
pub use resources::{Folder, NoResources, Resources};
pub use self_contained::{SelfContained, read_self_contained};
pub use warning::{Warning, WarningKind};
pub use write_options::{
    DEFAULT_TEXTURE_QUALITY, LEAST_DATA_QUALITY, MeshCompression, TextureFormat, WriteOptions, Written,
    WrittenMesh, WrittenTexture,
};
