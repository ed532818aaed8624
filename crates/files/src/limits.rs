//! How much a file may ask for, and where. Everything that a file *declares* is held against
//! these before memory is reserved for it, so that a few hostile bytes cannot ask
//! for gigabytes.

/// Upper bounds on what is read. All are inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file; for glTF also of all its external buffers together.
    pub max_file_bytes: u64,
    /// Vertices of the merged mesh, instances counted; also positions in an OBJ file.
    pub max_vertices: usize,
    /// Triangles of the merged mesh, instances counted.
    pub max_triangles: usize,
    /// Texels along either side of an image.
    pub max_image_side: u32,
    /// Texels of an image.
    pub max_image_pixels: u64,
    /// Texels of all images of one model together.
    pub max_total_pixels: u64,
    /// JSON objects in a glTF document, each of which costs a few hundred bytes in
    /// memory; also primitives placed by its nodes, instances counted.
    pub max_json_objects: usize,
    /// Whether every file that a model names must lie in the model's own folder or below it, links
    /// resolved: for services that read what strangers send. `..` that leads out, absolute paths and
    /// links to elsewhere are then errors, but for absolute paths of which a file of the same name lies
    /// beside the model. Otherwise `..`, links and absolute paths are followed. Default: not confined.
    pub confine: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_file_bytes: 4 << 30,
            max_vertices: 50_000_000,
            max_triangles: 100_000_000,
            max_image_side: 16_384,
            max_image_pixels: 1 << 28,
            max_total_pixels: 1 << 29,
            max_json_objects: 2_000_000,
            confine: false,
        }
    }
}
