// How long the graphics processor takes, where the browser tells (EXT_disjoint_timer_query_webgl2).

export class GpuTimer {
  constructor(gl) {
    this.gl = gl;
    this.extension = gl.getExtension('EXT_disjoint_timer_query_webgl2');
    this.pending = null;
    /** Milliseconds of the last measured run; null where there is none. */
    this.milliseconds = null;
  }

  get isAvailable() { return this.extension !== null; }

  run(work) {
    const { gl, extension } = this;
    this.poll();
    if (!extension || this.pending) return work();
    const query = gl.createQuery();
    gl.beginQuery(extension.TIME_ELAPSED_EXT, query);
    work();
    gl.endQuery(extension.TIME_ELAPSED_EXT);
    this.pending = query;
  }

  /** Fetches a result that has become ready; whether one is still awaited. */
  poll() {
    const { gl, extension, pending } = this;
    if (!pending || !gl.getQueryParameter(pending, gl.QUERY_RESULT_AVAILABLE)) return pending !== null;
    if (!gl.getParameter(extension.GPU_DISJOINT_EXT))
      this.milliseconds = gl.getQueryParameter(pending, gl.QUERY_RESULT) / 1e6;
    gl.deleteQuery(pending);
    this.pending = null;
    return false;
  }
}
