// Materials with maps in a scene, and their switch.

/** All materials below an object that have parallax maps. */
export function parallaxMaterials(root) {
  const found = new Set();
  root.traverse((object) => {
    for (const material of [object.material ?? []].flat()) if (material.parallax) found.add(material);
  });
  return [...found];
}

/** Switches the maps of all materials below an object on or off. */
export function setParallax(root, isOn) {
  for (const material of parallaxMaterials(root)) material.parallax.enabled = isOn;
}
