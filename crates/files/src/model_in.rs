//! One door for all model formats: chosen by the first bytes, then the extension.

use crate::context::{Context, Textures};
use crate::resources::{begins_with, read_file};
use crate::words::shown;
use crate::{FileError, Folder, Limits, Loaded, Place, Warning, gltf, obj};
use std::ffi::OsString;
use std::path::Path;

const SUPPORTED: &str = "OBJ (.obj) and glTF 2.0 (.gltf, .glb)";

/// Reads an `.obj`, `.gltf` or `.glb` file with all that it refers to.
///
/// # Errors
/// When the file or a buffer of it cannot be read, breaks its format, needs what is
/// not supported, is over the limits, or has no triangles; when a picture that a
/// material uses is there but cannot be decoded. A picture that is not there is a
/// warning.
pub fn read_model(path: &Path, limits: &Limits) -> Result<Loaded, FileError> {
    read(path, limits, Textures::Decode)
}

/// Like [`read_model`], with the encoded files of its textures ([`Loaded::pictures`]), so that
/// [`write_glb_keeping`](crate::write_glb_keeping) can copy them unchanged.
///
/// # Errors
/// As [`read_model`].
pub fn read_model_with_pictures(path: &Path, limits: &Limits) -> Result<Loaded, FileError> {
    let (resources, bytes) = opened(path, limits)?;
    let mut context = Context::new(path, &resources, limits, Textures::Decode);
    context.keeps_pictures = true;
    parsed_in(context, path, &bytes)
}

/// Like [`read_model`], with the importances that are painted in a vertex attribute of a glTF file
/// ([`Model::painted`](parbake_model::Model::painted)): one number, or a colour's red.
///
/// # Errors
/// As [`read_model`]; also where no mesh has the attribute.
pub fn read_painted_model(path: &Path, attribute: &str, limits: &Limits) -> Result<Loaded, FileError> {
    let (resources, bytes) = opened(path, limits)?;
    let mut context = Context::new(path, &resources, limits, Textures::Decode);
    context.attribute = Some(attribute);
    if !is_gltf(path, &bytes) {
        let reason = format!("an OBJ has no vertex attribute {attribute}; glTF files have");
        return Err(context.invalid(Place::File, reason));
    }
    let mut loaded = gltf::read(context, &bytes)?;
    name_model(path, &mut loaded.warnings);
    Ok(loaded)
}

/// Like [`read_model`], but opens no pictures: every material comes without
/// textures. For models whose look is not needed.
///
/// # Errors
/// As [`read_model`], except for those about pictures.
pub fn read_geometry(path: &Path, limits: &Limits) -> Result<Loaded, FileError> {
    read(path, limits, Textures::Skip)
}

fn read(path: &Path, limits: &Limits, textures: Textures) -> Result<Loaded, FileError> {
    let (resources, bytes) = opened(path, limits)?;
    parsed(path, &bytes, &resources, limits, textures)
}

/// The bytes of a model's file, if it may be one, and the folder of all that it refers to.
pub(crate) fn opened(path: &Path, limits: &Limits) -> Result<(Folder, Vec<u8>), FileError> {
    let known = ["obj", "gltf", "glb"].iter().any(|e| extension(path) == *e);
    let unreadable = |source| FileError::Read { path: path.into(), place: Place::File, source };
    let resources = Folder::beside(path).confined(limits.confine);
    let file = resources.model(path).map_err(unreadable)?;
    // What is no model may be gigabytes long; its first bytes are enough to say so.
    if !known && !begins_with(&file, gltf::MAGIC).map_err(unreadable)? {
        return Err(FileError::UnknownFormat { path: path.into(), supported: SUPPORTED });
    }
    let bytes = read_file(&file, limits.max_file_bytes).map_err(unreadable)?;
    Ok((resources, bytes))
}

/// Whether a file is glTF rather than OBJ.
pub(crate) fn is_gltf(path: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(gltf::MAGIC) || extension(path) != "obj"
}

fn extension(path: &Path) -> OsString {
    path.extension().map(|e| e.to_ascii_lowercase()).unwrap_or_default()
}

/// The model in the bytes of a file.
pub(crate) fn parsed(
    path: &Path,
    bytes: &[u8],
    resources: &Folder,
    limits: &Limits,
    textures: Textures,
) -> Result<Loaded, FileError> {
    parsed_in(Context::new(path, resources, limits, textures), path, bytes)
}

fn parsed_in(context: Context<'_>, path: &Path, bytes: &[u8]) -> Result<Loaded, FileError> {
    let mut loaded =
        if is_gltf(path, bytes) { gltf::read(context, bytes) } else { obj::read(context, bytes) }?;
    name_model(path, &mut loaded.warnings);
    Ok(loaded)
}

/// Two models are read for a bake: each warning names the one it is about.
pub(crate) fn name_model(path: &Path, warnings: &mut [Warning]) {
    let name = shown(&path.file_name().unwrap_or_default().to_string_lossy());
    warnings.iter_mut().for_each(|warning| warning.text = format!("{name}: {}", warning.text));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{WarningKind, glb_bytes};
    use parbake_model::glam::Vec3;
    use parbake_model::{Material, Mesh, Model};

    /// Protects the message for other formats: it says what can be read.
    #[test]
    fn unknown_extensions_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.fbx");
        std::fs::write(&path, b"Kaydara FBX Binary").unwrap();
        let error = read_model(&path, &Limits::default()).unwrap_err().to_string();
        assert!(error.contains("a.fbx") && error.contains(".obj"), "{error}");
        let missing = read_model(&folder.path().join("b.obj"), &Limits::default()).unwrap_err();
        assert!(missing.to_string().contains("cannot be read"), "{missing}");
    }

    /// Protects users from extensions that say nothing or the wrong thing, and from
    /// what is no file.
    #[test]
    fn first_bytes_count_more_than_extensions() {
        let folder = tempfile::tempdir().unwrap();
        let model = Model {
            mesh: Mesh {
                positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
                triangles: vec![[0, 1, 2]],
                triangle_materials: vec![0],
                ..Mesh::default()
            },
            materials: vec![Material::default()],
            ..Model::default()
        };
        let glb = glb_bytes(&model).unwrap();
        for name in ["download", "a.bin", "a.obj", "a.gltf"] {
            let path = folder.path().join(name);
            std::fs::write(&path, &glb).unwrap();
            assert_eq!(read_model(&path, &Limits::default()).unwrap().model.mesh, model.mesh, "{name}");
        }
        for path in [folder.path().to_path_buf(), folder.path().join("no/a.obj"), "/dev/zero".into()] {
            let error = read_model(&path, &Limits::default()).unwrap_err();
            assert!(matches!(error, FileError::Read { .. }), "{error}");
        }
    }

    /// Protects the user's look: where a picture is missing, the warning names the model, the material and
    /// the file.
    #[test]
    fn a_missing_picture_is_named_with_its_material_and_model() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chair.obj");
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("chair.mtl", "newmtl oak\nmap_Kd oak_color.png\n");
        write("chair.obj", "mtllib chair.mtl\nusemtl oak\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let warnings = read_model(&path, &Limits::default()).unwrap().warnings;
        let named = |warning: &Warning| {
            ["chair.obj", "oak", "oak_color.png"].iter().all(|n| warning.text.contains(n))
        };
        assert!(warnings.len() == 1 && named(&warnings[0]), "{warnings:?}");
        assert_eq!(warnings[0].kind, WarningKind::MissingTexture);
    }

    /// Protects old assets: an OBJ's texture may be a TGA, which is known by its name alone, also by an absolute one, and is counted as one.
    #[test]
    fn textures_of_old_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
        // One pixel of 24 bits, blue first.
        write("Oak.TGA", &[0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0x20, 7, 8, 9]);
        write("m.obj", format!("mtllib m.mtl\n{TRIANGLE}").as_bytes());
        for name in ["Oak.TGA", "C:\\textures\\Oak.TGA"] {
            write("m.mtl", format!("newmtl a\nmap_Kd {name}\n").as_bytes());
            let loaded = read_model(&folder.path().join("m.obj"), &Limits::default()).unwrap();
            assert_eq!(loaded.model.images[0].pixels, [[9, 8, 7, 255]], "{name}");
            assert_eq!(loaded.contents.pictures[0].format, crate::PictureFormat::Tga);
        }
    }

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";

    fn confined() -> Limits {
        Limits { confine: true, ..Limits::default() }
    }

    /// Protects artists' files: absolute paths, of Windows too, lead to the picture that lies beside the
    /// model, and a warning says so; where there is none, the warning names the path.
    #[test]
    fn absolute_paths_lead_to_files_beside_the_model() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("model");
        std::fs::create_dir_all(folder.join("textures")).unwrap();
        let png = crate::encode_png(&parbake_model::Image::solid("", 1, 1, [9, 9, 9, 255])).unwrap();
        std::fs::write(folder.join("textures/oak.png"), png).unwrap();
        let path = folder.join("m.obj");
        std::fs::write(folder.join("my lib.mtl"), "newmtl a\nmap_Kd C:\\Users\\me\\My Pictures\\oak.png\n")
            .unwrap();
        std::fs::write(&path, format!("mtllib /home/me/my work/my lib.mtl\n{TRIANGLE}")).unwrap();
        for limits in [Limits::default(), confined()] {
            let loaded = read_model(&path, &limits).unwrap();
            assert!(loaded.model.materials[0].base_color_texture.is_some(), "{:?}", loaded.warnings);
            assert!(
                loaded.warnings[0].text.contains("my lib.mtl")
                    && loaded.warnings[1].text.contains("\"textures/oak.png\"")
            );
        }
        std::fs::write(folder.join("my lib.mtl"), "newmtl a\nmap_Kd C:\\gone.png\n").unwrap();
        let warnings = read_model(&path, &Limits::default()).unwrap().warnings;
        assert!(warnings[1].text.contains("C:/gone.png"), "{warnings:?}");
    }

    /// Protects services that read what strangers send: nothing outside the model's folder is read,
    /// neither as a buffer nor as a picture nor as a library; one's own files are.
    #[test]
    fn a_confined_reading_stays_in_the_folder() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("model");
        std::fs::create_dir(&folder).unwrap();
        let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let secret = place.path().join("secret.bin");
        std::fs::write(&secret, positions.map(f32::to_le_bytes).as_flattened()).unwrap();
        let document = |uri: &str| {
            serde_json::json!({
                "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 36, "uri": uri }],
                "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
                "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
                "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            })
            .to_string()
        };
        let path = folder.join("m.gltf");
        let absolute = secret.to_string_lossy().into_owned();
        for uri in ["../secret.bin", absolute.as_str()] {
            std::fs::write(&path, document(uri)).unwrap();
            assert!(read_model(&path, &Limits::default()).is_ok(), "{uri}");
            let error = read_model(&path, &confined()).unwrap_err().to_string();
            assert!(
                error.contains("/buffers/0/uri") && error.contains("outside the model's folder"),
                "{error}"
            );
        }
        let obj = folder.join("m.obj");
        for line in ["mtllib ../secret.mtl", "mtllib m.mtl"] {
            std::fs::write(&obj, format!("{line}\n{TRIANGLE}")).unwrap();
            std::fs::write(folder.join("m.mtl"), "newmtl a\nmap_Kd ../secret.png\n").unwrap();
            assert!(read_model(&obj, &Limits::default()).is_ok(), "{line}");
            let error = read_model(&obj, &confined()).unwrap_err().to_string();
            assert!(error.contains("secret.") && error.contains("outside the model's folder"), "{error}");
        }
        #[cfg(unix)]
        {
            let link = folder.join("link.gltf");
            std::fs::write(place.path().join("there.gltf"), document("secret.bin")).unwrap();
            std::os::unix::fs::symlink(place.path().join("there.gltf"), &link).unwrap();
            let error = read_model(&link, &confined()).unwrap_err().to_string();
            assert!(error.contains("outside the model's folder"), "{error}");
        }
    }

    /// Protects capital extensions, as old exporters write them.
    #[test]
    fn extensions_may_be_capital() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("A.OBJ");
        std::fs::write(&path, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        assert_eq!(read_model(&path, &Limits::default()).unwrap().model.mesh.triangles.len(), 1);
    }
}
