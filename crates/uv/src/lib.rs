//! Texture coordinates that move.
