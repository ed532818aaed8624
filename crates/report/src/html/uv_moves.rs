//! The moves of the texture coordinates on the page, as an animated picture.

use crate::page::base64;
use crate::uv_animation::{UvAnimationOptions, uv_animation};
use parbake::BakeError;
use parbake::UvMoves;

/// The animation with its caption; nothing where nothing moved.
pub fn uv_moves(moves: Option<&UvMoves>) -> Result<String, BakeError> {
    let Some(moves) = moves.filter(|moves| moves.frames.len() > 1) else { return Ok(String::new()) };
    let mut address = String::from("data:image/gif;base64,");
    base64(&uv_animation(moves, &UvAnimationOptions::default())?, &mut address);
    Ok(format!(
        concat!(
            r#"<figure class="moves"><img src="{}" alt="The texture layout on its way through the run">"#,
            "<figcaption>The texture layout on its way through the run, which ends where the bar below is full. ",
            "Each chart has a colour of its own; flipped triangles would be red.</figcaption></figure>"
        ),
        address
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec2;

    /// Protects runs that did not move anything from an empty section.
    #[test]
    fn only_moves_are_shown() {
        let mut moves = UvMoves {
            frames: vec![vec![Vec2::ZERO, Vec2::X, Vec2::Y]],
            triangles: vec![[0, 1, 2]],
            charts: vec![0],
        };
        assert_eq!(uv_moves(None).unwrap(), "");
        assert_eq!(uv_moves(Some(&moves)).unwrap(), "");
        moves.frames.push(vec![Vec2::ZERO, Vec2::X, Vec2::ONE]);
        // "R0lGODlh" is "GIF89a".
        assert!(uv_moves(Some(&moves)).unwrap().contains(r#"src="data:image/gif;base64,R0lGODlh"#));
    }
}
