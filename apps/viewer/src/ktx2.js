// KTX2 textures. Basis Universal's transcoder makes functions from text, which the page's policy forbids, and rightly:
// so its worker is a file of its own, with a policy of its own, instead of a blob that inherits the page's
// (build.mjs puts it together as KTX2Loader would).
import { KTX2Loader } from './vendor.js';

export class Ktx2 extends KTX2Loader {
  /** `broken` is told if a worker fails: no answer would come then. */
  constructor(manager, broken) {
    super(manager);
    this.broken = broken;
  }

  init() {
    this.transcoderPending ??= fetch('basis/basis_transcoder.wasm').then((r) => r.arrayBuffer()).then((binary) => {
      this.workerPool.setWorkerCreator(() => {
        const worker = new Worker('basis/worker.js'), transcoderBinary = binary.slice(0);
        worker.addEventListener('error', (event) => this.broken(new Error(`KTX2: ${event.message}`)));
        worker.postMessage({ type: 'init', config: this.workerConfig, transcoderBinary }, [transcoderBinary]);
        return worker;
      });
    });
    return this.transcoderPending;
  }
}
