//! What of the high-poly's material extensions is lost where only light on a matte surface is fitted.

use parbake_model::{Material, MaterialExtensions, Specular};

/// Materials that a warning names; the others are counted.
const MOST_NAMES: usize = 5;

/// An extension, what is lost without it, and whether a material has it with an effect.
type Loss = (&'static str, &'static str, fn(&MaterialExtensions) -> bool);

const LOSSES: [Loss; 10] = [
    ("KHR_materials_clearcoat", "the gloss of the clear layer on top", |e| {
        e.clearcoat.is_some_and(|c| c.factor > 0.0)
    }),
    ("KHR_materials_sheen", "the soft light of cloth at grazing angles", |e| {
        e.sheen.is_some_and(|s| s.color != [0.0; 3])
    }),
    ("KHR_materials_transmission", "refraction, blur and tint of what is seen through the surface", |e| {
        e.transmission.is_some_and(|t| t.factor > 0.0)
    }),
    ("KHR_materials_diffuse_transmission", "the light that shines through from behind", |e| {
        e.diffuse_transmission.is_some_and(|d| d.factor > 0.0)
    }),
    ("KHR_materials_volume", "refraction and the colour that thickness gives", |e| {
        e.volume.is_some_and(|v| v.thickness > 0.0)
    }),
    ("KHR_materials_iridescence", "the colours of the thin film", |e| {
        e.iridescence.is_some_and(|i| i.factor > 0.0)
    }),
    ("KHR_materials_anisotropy", "the stretch of highlights", |e| {
        e.anisotropy.is_some_and(|a| a.strength > 0.0)
    }),
    ("KHR_materials_specular", "the strength and the colour of reflections", |e| {
        e.specular.is_some_and(|s| s != Specular::default())
    }),
    ("KHR_materials_ior", "reflections that are stronger or weaker than those of an index of 1.5", |e| {
        e.ior.is_some_and(|ior| ior != 1.5)
    }),
    ("KHR_materials_dispersion", "the rainbow that refraction makes", |e| {
        e.dispersion.is_some_and(|d| d > 0.0)
    }),
];

/// What is lost, an extension at a time: models have many materials.
pub(crate) fn lost(materials: &[Material]) -> Vec<String> {
    let of = |&(name, lost, has): &Loss| {
        let having: Vec<&Material> = materials.iter().filter(|m| has(&m.extensions)).collect();
        let names: Vec<String> = having.iter().take(MOST_NAMES).map(|m| format!("{:?}", m.name)).collect();
        let more = match having.len() - names.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let noun = if having.len() == 1 { "material" } else { "materials" };
        (!having.is_empty()).then(|| {
            format!(
                "{name} is not kept with this shading: {lost} is lost in {noun} {}{more}",
                names.join(", ")
            )
        })
    };
    LOSSES.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::Sheen;

    /// Protects the user from losses without a word, and from words where nothing is lost.
    #[test]
    fn losses_are_told_where_there_are_some() {
        let mut cloth = Material { name: "cloth".into(), ..Material::default() };
        cloth.extensions.sheen = Some(Sheen { color: [1.0; 3], ..Sheen::default() });
        cloth.extensions.specular = Some(Specular::default());
        cloth.extensions.ior = Some(1.5);
        let told = lost(&[cloth, Material::default()]);
        assert!(
            told.len() == 1 && told[0].contains("KHR_materials_sheen") && told[0].contains("cloth"),
            "{told:?}"
        );
    }
}
