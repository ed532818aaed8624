// Levels of detail: several files, or one file with MSFT_lod; which level a size on the screen calls for.

export class Levels {
  /** `models` are the files, the finest first; a single one may have levels of its own. */
  constructor(models) {
    this.models = models;
    this.count = models.length > 1 ? models.length : models[0].levels;
    this.coverage = models.length > 1 ? null : models[0].coverage;
    this.shown = 0;
    this.figures = Array.from({ length: this.count }, (_, level) => {
      this.show(level);
      return models.length > 1 ? models[level].figures() : models[0].figures();
    });
    this.show(0);
  }

  /** Shows one level; `null` shows none, which MSFT_lod asks for below its last coverage. */
  show(level) {
    this.shown = level;
    if (this.models.length > 1) this.models.forEach((model, index) => { model.root.visible = index === level; });
    else this.models[0].showLevel(level);
  }

  /** The model that is shown, or the finest where none is. */
  model() {
    return this.models.length > 1 ? this.models[this.shown ?? 0] : this.models[0];
  }

  /**
   * The level for a model that spans so many pixels of a screen: by MSFT_screencoverage (the share of the screen's
   * area that the bounding sphere covers) where the file has it, else each takes over at half the size of the one
   * before it, the first down to half of the screen's shorter side.
   */
  forSize(pixels, width, height) {
    if (this.coverage) {
      const share = Math.min(1, (Math.PI / 4) * pixels * pixels / (width * height));
      const level = this.coverage.findIndex((least) => share >= least);
      if (level >= 0) return Math.min(level, this.count - 1);
      return this.coverage.length >= this.count ? null : this.count - 1;
    }
    const halvings = Math.floor(Math.log2((0.5 * Math.min(width, height)) / pixels)) + 1;
    return Math.min(this.count - 1, Math.max(0, halvings));
  }
}
