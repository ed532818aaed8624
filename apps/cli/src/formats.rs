//! How GLB files are written: the options of all commands that write one, and what is told of it.

use crate::failure::Failure;
use crate::outputs::is_obj;
use crate::progress::Console;
use clap::{Args, ValueEnum};
use parbake::{
    DEFAULT_TEXTURE_QUALITY, MeshCompression, Model, TextureFormat, WriteOptions, Written, write_glb_with,
    write_obj,
};
use std::path::Path;

/// How a GLB file is written.
#[derive(Args, Clone, Copy, Debug)]
pub struct FormatOptions {
    /// Image format of the textures in a GLB file
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = TextureFormatName::Png)]
    pub texture_format: TextureFormatName,

    /// Quality of JPEG textures, 1 to 100; normal maps and data maps have at least 95
    #[arg(long, value_name = "QUALITY", default_value_t = DEFAULT_TEXTURE_QUALITY, value_parser = clap::value_parser!(u8).range(1..=100))]
    pub texture_quality: u8,

    /// Compression of the mesh in a GLB file
    #[arg(long, value_enum, value_name = "COMPRESSION", default_value_t = MeshCompressionName::None)]
    pub mesh_compression: MeshCompressionName,
}

/// Values of `--texture-format`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureFormatName {
    /// Lossless
    Png,
    /// Lossy; textures with alpha and parallax maps stay PNG
    Jpeg,
    /// Lossless WebP, often larger than our packed PNG; viewers need EXT_texture_webp
    Webp,
}

/// Values of `--mesh-compression`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshCompressionName {
    /// Floats
    None,
    /// 16-bit positions, 8-bit normals: KHR_mesh_quantization
    Quantized,
    /// Quantised, then encoded without loss: EXT_meshopt_compression
    Meshopt,
}

impl Default for FormatOptions {
    fn default() -> Self {
        Self {
            texture_format: TextureFormatName::Png,
            texture_quality: DEFAULT_TEXTURE_QUALITY,
            mesh_compression: MeshCompressionName::None,
        }
    }
}

impl FormatOptions {
    /// Refuses options that an OBJ has no place for.
    pub fn check(&self, output: &Path) -> Result<(), Failure> {
        let name = if self.texture_format != TextureFormatName::Png {
            "--texture-format"
        } else if self.mesh_compression != MeshCompressionName::None {
            "--mesh-compression"
        } else {
            return Ok(());
        };
        if is_obj(output) {
            return Err(Failure::Usage(format!(
                "{name} acts on GLB files only; {} is an OBJ",
                output.display()
            )));
        }
        Ok(())
    }

    fn write_options(&self) -> WriteOptions {
        WriteOptions {
            texture_format: match self.texture_format {
                TextureFormatName::Png => TextureFormat::Png,
                TextureFormatName::Jpeg => TextureFormat::Jpeg,
                TextureFormatName::Webp => TextureFormat::Webp,
            },
            texture_quality: self.texture_quality,
            mesh_compression: match self.mesh_compression {
                MeshCompressionName::None => MeshCompression::None,
                MeshCompressionName::Quantized => MeshCompression::Quantized,
                MeshCompressionName::Meshopt => MeshCompression::Meshopt,
            },
        }
    }
}

/// Writes a model as its extension says, tells what formats other than the default lost, and returns the
/// bytes of all files.
pub fn write_model(
    path: &Path,
    model: &Model,
    formats: &FormatOptions,
    console: &Console,
) -> Result<u64, Failure> {
    if is_obj(path) {
        if model.materials.iter().any(|material| material.extensions.show()) {
            console.say(&format!(
                "warning: {}: OBJ has no place for glTF's material extensions (transmission, clearcoat, sheen, …); write a .glb \
                 to keep them",
                path.display()
            ));
        }
        return Ok(write_obj(path, model)?);
    }
    let options = formats.write_options();
    let written = write_glb_with(path, model, &options)?;
    if options != WriteOptions::default() {
        for line in losses(&written) {
            console.say(&line);
        }
    }
    Ok(written.bytes)
}

/// One line for each texture and one for the mesh.
fn losses(written: &Written) -> Vec<String> {
    let texture = |texture: &parbake::WrittenTexture| {
        let loss = texture.psnr.map_or("without loss".into(), |psnr| format!("{psnr:.1} dB"));
        format!("{}: {} bytes as {}, {loss}", texture.name, texture.bytes, texture.mime_type)
    };
    let mut lines: Vec<String> = written.textures.iter().map(texture).collect();
    let error = match written.position_error {
        0.0 => "without loss".into(),
        error => format!("positions within {error:.2e} units"),
    };
    lines.push(format!("mesh: {} bytes, {error}", written.mesh_bytes));
    lines
}
