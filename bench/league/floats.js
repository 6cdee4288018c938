// A page's WebGL2 canvas in floats: what would go to its 8 bits goes to a framebuffer of 32-bit floats, and `mediump`,
// which some drivers take as 16 bits, is `highp`. Frames come a tenth of a second apart. leagueFloats() returns the pixels;
// leagueOrder is how the page's worker last sorted the Gaussians, from the back to the front.
(() => {
  window.Worker = class extends Worker {
    constructor(...args) {
      super(...args);
      this.addEventListener('message', e => {
        const order = e.data && (e.data.order || e.data.sortedIndexes || e.data.depthIndex);
        if (order) window.leagueOrder = Array.from(new Uint32Array(order));
      });
    }
  };
  window.requestAnimationFrame = f => setTimeout(() => f(performance.now()), 100);
  window.cancelAnimationFrame = id => clearTimeout(id);
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    const gl = get.call(this, kind, Object.assign({}, options, {preserveDrawingBuffer: true, antialias: false}));
    if (!/^webgl2/.test(kind) || !gl || gl.own) return gl;
    const own = gl.own = {};
    own.ext = [gl.getExtension('EXT_color_buffer_float'), gl.getExtension('EXT_float_blend')].map(x => !!x);
    const bind = gl.bindFramebuffer.bind(gl), draws = gl.drawBuffers.bind(gl);
    const ready = () => {
      const w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
      if (own.frame && own.w === w && own.h === h) return own.frame;
      const texture = gl.getParameter(gl.TEXTURE_BINDING_2D), buffer = gl.getParameter(gl.RENDERBUFFER_BINDING);
      own.frame = gl.createFramebuffer(); own.w = w; own.h = h;
      own.color = gl.createRenderbuffer(); own.depth = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, own.color); gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, w, h);
      gl.bindRenderbuffer(gl.RENDERBUFFER, own.depth); gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH24_STENCIL8, w, h);
      bind(gl.FRAMEBUFFER, own.frame);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, own.color);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_STENCIL_ATTACHMENT, gl.RENDERBUFFER, own.depth);
      own.status = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      return own.frame;
    };
    own.bound = null;
    gl.bindFramebuffer = (target, frame) => { own.bound = frame; bind(target, frame || ready()); };
    const source = gl.shaderSource.bind(gl);
    gl.shaderSource = (shader, text) => source(shader, text.replace(/\bmediump\b/g, 'highp'));
    gl.drawBuffers = list => draws(!own.bound ? list.map(x => x === gl.BACK ? gl.COLOR_ATTACHMENT0 : x) : list);
    for (const name of ['clear', 'drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced', 'drawRangeElements', 'viewport']) {
      const call = gl[name].bind(gl);
      gl[name] = (...args) => { if (!own.bound) bind(gl.FRAMEBUFFER, ready()); return call(...args); };
    }
    window.leagueFloats = () => {
      const data = new Float32Array(4 * own.w * own.h);
      bind(gl.READ_FRAMEBUFFER, own.frame);
      gl.readPixels(0, 0, own.w, own.h, gl.RGBA, gl.FLOAT, data);
      const bytes = new Uint8Array(data.buffer); let text = '';
      for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
      return {w: own.w, h: own.h, ext: own.ext, status: own.status, error: gl.getError(), data: btoa(text)};
    };
    return gl;
  };
})();
