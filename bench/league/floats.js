// A page's WebGL2 canvas in floats: what would go to its 8 bits goes to a framebuffer of 32-bit floats, and `mediump`,
// which some drivers take as 16 bits, is `highp`, as is what half floats are unpacked to. Frames come a tenth of a second
// apart. league.still() tells how many looks found the same, league.floats() the pixels; leagueOrder is how the page's
// worker last sorted the Gaussians, from the back to the front.
(() => {
  window.Worker = class extends Worker {
    constructor(...args) {
      super(...args);
      this.addEventListener('message', e => {
        const order = e.data && (e.data.order || e.data.sortedIndexes || e.data.sortedIndices || e.data.depthIndex);
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
    for (const name of ['EXT_color_buffer_float', 'EXT_float_blend']) gl.getExtension(name);
    const bind = gl.bindFramebuffer.bind(gl), draws = gl.drawBuffers.bind(gl);
    const ready = () => {
      const w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
      if (own.frame && own.w === w && own.h === h) return own.frame;
      const texture = gl.getParameter(gl.TEXTURE_BINDING_2D), buffer = gl.getParameter(gl.RENDERBUFFER_BINDING);
      own.frame = gl.createFramebuffer(); own.w = w; own.h = h; window.league = own;
      own.color = gl.createRenderbuffer(); own.depth = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, own.color); gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, w, h);
      gl.bindRenderbuffer(gl.RENDERBUFFER, own.depth); gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH24_STENCIL8, w, h);
      bind(gl.FRAMEBUFFER, own.frame);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, own.color);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_STENCIL_ATTACHMENT, gl.RENDERBUFFER, own.depth);
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      return own.frame;
    };
    own.bound = null;
    gl.bindFramebuffer = (target, frame) => { own.bound = frame; bind(target, frame || ready()); };
    const source = gl.shaderSource.bind(gl);
    gl.shaderSource = (shader, text) => {
      text = text.replace(/\bmediump\b/g, 'highp');
      if (/\bunpackHalf2x16\b/.test(text)) // which is mediump, and so is what is computed of it
        text = text.replace(/\bunpackHalf2x16\b/g, 'leagueHalf').replace(/^((\s*#(version|extension)[^\n]*\n)*)/,
          '$1highp vec2 leagueHalf(highp uint x) { highp vec2 y = unpackHalf2x16(x); return y; }\n');
      source(shader, text);
    };
    gl.drawBuffers = list => draws(!own.bound ? list.map(x => x === gl.BACK ? gl.COLOR_ATTACHMENT0 : x) : list);
    for (const name of ['clear', 'drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced', 'drawRangeElements', 'viewport']) {
      const call = gl[name].bind(gl);
      gl[name] = (...args) => { if (!own.bound) bind(gl.FRAMEBUFFER, ready()); return call(...args); };
    }
    own.read = () => {
      const data = new Float32Array(4 * own.w * own.h);
      bind(gl.READ_FRAMEBUFFER, own.frame);
      gl.readPixels(0, 0, own.w, own.h, gl.RGBA, gl.FLOAT, data);
      return new Uint32Array(data.buffer);
    };
    own.still = () => {
      const data = own.read(), last = own.last;
      own.same = last && last.length === data.length && data.every((x, i) => x === last[i]) ? own.same + 1 : 0;
      own.last = data;
      return {same: own.same, empty: !data.some(x => x)};
    };
    own.floats = () => {
      const bytes = new Uint8Array(own.read().buffer);
      let text = '';
      for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
      return {w: own.w, h: own.h, data: btoa(text)};
    };
    return gl;
  };
})();
