//! How models are written: by the output's extension, with the formats that were asked for, and what is told of
//! what that lost.

use crate::failure::Failure;
use crate::outputs::is_obj;
use crate::progress::Console;
use parbake::{
    MeshCompression, Model, PictureFiles, TextureFormat, WriteOptions, Written, WrittenTexture,
    write_glb_keeping, write_obj,
};
use std::path::Path;

/// Refuses formats that an OBJ has no place for.
pub fn check_formats(output: &Path, options: &WriteOptions) -> Result<(), Failure> {
    let name = if options.texture_format != TextureFormat::Png {
        "--texture-format"
    } else if options.mesh_compression != MeshCompression::None {
        "--mesh-compression"
    } else {
        return Ok(());
    };
    if is_obj(output) {
        return Err(Failure::Usage(format!("{name} acts on GLB files only; {} is an OBJ", output.display())));
    }
    Ok(())
}

/// Writes a model as its extension says and tells what formats other than the default lost. Returns the
/// bytes of all files, and what a GLB holds.
pub fn write_model(
    path: &Path,
    model: &Model,
    options: &WriteOptions,
    console: &Console,
) -> Result<(u64, Option<Written>), Failure> {
    write_model_keeping(path, model, options, &PictureFiles::default(), console)
}

/// As [`write_model`]; textures of a GLB that are still those of `files` are written as these files.
pub fn write_model_keeping(
    path: &Path,
    model: &Model,
    options: &WriteOptions,
    files: &PictureFiles,
    console: &Console,
) -> Result<(u64, Option<Written>), Failure> {
    if is_obj(path) {
        if model.materials.iter().any(|material| material.extensions.show()) {
            console.say(&format!(
                "warning: {}: OBJ has no place for glTF's material extensions (transmission, clearcoat, sheen, …); write a .glb \
                 to keep them",
                path.display()
            ));
        }
        if model.rig.is_some() {
            console.say(&format!(
                "warning: {}: OBJ has no place for skins, morph targets and animations; write a .glb to keep them",
                path.display()
            ));
        }
        return Ok((write_obj(path, model)?, None));
    }
    let written = write_glb_keeping(path, model, options, files)?;
    if (WriteOptions { is_urgent: false, ..*options }) != WriteOptions::default() {
        for line in losses(&written) {
            console.say(&line);
        }
    }
    Ok((written.bytes, Some(written)))
}

/// One line for each texture and one for the mesh.
fn losses(written: &Written) -> Vec<String> {
    let texture = |WrittenTexture { name, format, bytes, psnr, reason }: &WrittenTexture| {
        let loss = psnr.map_or("without loss".into(), |psnr| format!("{psnr:.1} dB"));
        let reason = reason.as_ref().map_or(String::new(), |reason| format!(": {reason}"));
        format!("{name}: {bytes} bytes as {}, {loss}{reason}", format.label())
    };
    let mut lines: Vec<String> = written.textures.iter().map(texture).collect();
    let error = match written.mesh.position_error {
        0.0 => "without loss".into(),
        error => format!("positions within {error:.2e} units"),
    };
    lines.push(format!("mesh: {} bytes, {error}", written.mesh.bytes));
    lines
}
