// A small WebGL 2 renderer: shaded meshes with outlines, round points, lines.
const MESH_VERTEX = `#version 300 es
layout(location=0) in vec3 position; layout(location=1) in vec3 normal;
uniform mat4 view, model; uniform float grow; uniform vec2 size;
out vec3 n;
void main() {
  n = mat3(model) * normal;
  gl_Position = view * (model * vec4(position, 1.0));
  vec4 tip = view * (model * vec4(position + 0.01 * normal, 1.0));
  vec2 away = tip.xy / tip.w - gl_Position.xy / gl_Position.w;
  float far = length(away * size);
  if (grow > 0.0 && far > 1e-4) gl_Position.xy += 2.0 * grow * normalize(away * size) / size * gl_Position.w;
}`;
const MESH_FRAGMENT = `#version 300 es
precision mediump float;
in vec3 n; uniform vec4 colour; uniform float flat_; out vec4 o;
void main() {
  vec3 m = normalize(n);
  float light = 0.62 + 0.30 * max(dot(m, normalize(vec3(-0.5, -0.6, 0.9))), 0.0) + 0.14 * m.z;
  o = vec4(colour.rgb * mix(light, 1.0, flat_), colour.a);
}`;
const POINT_VERTEX = `#version 300 es
layout(location=0) in vec3 position; uniform mat4 view; uniform float size, high;
void main() { gl_Position = view * vec4(position, 1.0); gl_PointSize = max(3.0, size * high / gl_Position.w); }`;
const POINT_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec4 colour; out vec4 o;
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0; float r = dot(d, d);
  if (r > 1.0) discard;
  float light = 0.8 + 0.3 * dot(vec3(d.x, -d.y, sqrt(1.0 - r)), normalize(vec3(-0.4, 0.6, 0.7)));
  o = vec4(colour.rgb * light, colour.a);
}`;
const LINE_VERTEX = `#version 300 es
layout(location=0) in vec3 position; uniform mat4 view;
void main() { gl_Position = view * vec4(position, 1.0); }`;
const LINE_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec4 colour; out vec4 o; void main() { o = colour; }`;

export const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);

export class Renderer {
  // Throws where the browser has no WebGL 2.
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("no WebGL 2");
    this.gl = gl;
    this.canvas = canvas;
    this.mesh = program(gl, MESH_VERTEX, MESH_FRAGMENT);
    this.point = program(gl, POINT_VERTEX, POINT_FRAGMENT);
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.buffer = gl.createBuffer();
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindVertexArray(null);
  }

  // Read what page_messages.encode_mesh wrote.
  upload(data) {
    const gl = this.gl;
    const [vertices, faces] = new Uint32Array(data, 0, 2);
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    for (const k of [0, 1]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data, 8 + 12 * vertices * k, 3 * vertices), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(data, 8 + 24 * vertices, 3 * faces), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, count: 3 * faces };
  }

  begin(view) {
    const gl = this.gl;
    this.view = view;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0.965, 0.97, 0.975, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  // grow: width of the outline in pixels; 0: the mesh itself.
  drawMesh(mesh, model, colour, grow = 0, alpha = 1) {
    const { gl, mesh: p } = this;
    gl.useProgram(p.id);
    gl.uniformMatrix4fv(p.at("view"), false, this.view);
    gl.uniformMatrix4fv(p.at("model"), false, model);
    gl.uniform4f(p.at("colour"), ...rgb(colour), alpha);
    gl.uniform1f(p.at("grow"), grow);
    gl.uniform1f(p.at("flat_"), grow ? 1 : 0);
    gl.uniform2f(p.at("size"), this.canvas.width, this.canvas.height);
    if (grow) {
      gl.enable(gl.CULL_FACE);
      gl.cullFace(gl.FRONT);
    }
    gl.bindVertexArray(mesh.array);
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
    gl.disable(gl.CULL_FACE);
  }

  drawPoints(numbers, colour, size, zoom, alpha = 1) {
    if (!numbers.length) return;
    const { gl, point: p } = this;
    gl.useProgram(p.id);
    gl.uniformMatrix4fv(p.at("view"), false, this.view);
    gl.uniform4f(p.at("colour"), ...rgb(colour), alpha);
    gl.uniform1f(p.at("size"), size);
    gl.uniform1f(p.at("high"), 0.5 * zoom * this.canvas.height);
    this.#stream(numbers, gl.POINTS);
  }

  drawLines(numbers, colour, alpha = 1) {
    if (!numbers.length) return;
    const { gl, line: p } = this;
    gl.useProgram(p.id);
    gl.uniformMatrix4fv(p.at("view"), false, this.view);
    gl.uniform4f(p.at("colour"), ...rgb(colour), alpha);
    this.#stream(numbers, gl.LINES);
  }

  #stream(numbers, kind) {
    const gl = this.gl;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
    gl.drawArrays(kind, 0, numbers.length / 3);
    gl.bindVertexArray(null);
  }
}

function program(gl, vertex, fragment) {
  const id = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(id, shader);
  }
  gl.linkProgram(id);
  if (!gl.getProgramParameter(id, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(id) ?? "shader");
  const places = new Map();
  return {
    id,
    at(name) {
      if (!places.has(name)) places.set(name, gl.getUniformLocation(id, name));
      return places.get(name);
    },
  };
}
