import { Buffer, BufferUsage, Geometry, GlProgram, Mesh, Shader, UniformGroup } from "pixi.js";
import { colourOfActor } from "../../roads/actorShapes";
import type { Palette } from "../../roads/palette";
import type { Recording } from "./recording";

const EVERY_S = 0.25;
const HALF_PX = 1.2;
const FLOATS = 8;

const VERTEX = `
in vec2 aPosition;
in vec2 aNormal;
in float aTime;
in vec3 aColour;
out float vTime;
out vec3 vColour;
uniform mat3 uProjectionMatrix;
uniform mat3 uWorldTransformMatrix;
uniform mat3 uTransformMatrix;
uniform float uHalf;
void main() {
  vec2 place = aPosition + aNormal * uHalf;
  mat3 matrix = uProjectionMatrix * uWorldTransformMatrix * uTransformMatrix;
  gl_Position = vec4((matrix * vec3(place, 1.0)).xy, 0.0, 1.0);
  vTime = aTime;
  vColour = aColour;
}`;
const FRAGMENT = `
in float vTime;
in vec3 vColour;
out vec4 finalColor;
uniform float uNow;
uniform float uLast;
void main() {
  float age = uNow - vTime;
  if (age < 0.0 || age > uLast) discard;
  float alpha = 0.75 - 0.5 * age / uLast;
  finalColor = vec4(vColour * alpha, alpha);
}`;

/** The ways of all actors in one piece: the graphics card leaves out what is not to be seen. */
export class TrailLayer extends Mesh<Geometry, Shader> {
  private readonly values: { uNow: number; uLast: number; uHalf: number };

  constructor(recording: Recording, palette: Palette, hidden: ReadonlySet<number>) {
    const uniforms = new UniformGroup({
      uNow: { value: 0, type: "f32" },
      uLast: { value: 5, type: "f32" },
      uHalf: { value: 0.1, type: "f32" },
    });
    super({
      geometry: waysOf(recording, palette, hidden),
      shader: new Shader({
        glProgram: GlProgram.from({ vertex: VERTEX, fragment: FRAGMENT, name: "trails" }),
        resources: { trails: uniforms },
      }),
    });
    this.values = uniforms.uniforms;
  }

  /** Shows the last seconds before a time. */
  show(time: number, seconds: number, scale: number): void {
    this.visible = seconds > 0;
    this.values.uNow = time;
    this.values.uLast = seconds;
    this.values.uHalf = HALF_PX / scale;
  }
}

function waysOf(recording: Recording, palette: Palette, hidden: ReadonlySet<number>): Geometry {
  const count = recording.actors.length;
  const every = Math.max(1, Math.round(EVERY_S / recording.stepLength));
  const vertices: number[] = [];
  const indices: number[] = [];
  for (const actor of recording.actors) {
    if (actor.role === "npc_obstacle" || hidden.has(actor.row)) continue;
    const colour = colourOfActor(actor, palette);
    const red = ((colour >> 16) & 255) / 255;
    const green = ((colour >> 8) & 255) / 255;
    const blue = (colour & 255) / 255;
    let joined = false;
    for (let step = 0; step < recording.loaded; step += every) {
      const cell = step * count + actor.row;
      const x = recording.x[cell] as number;
      const y = recording.y[cell] as number;
      if (Number.isNaN(x)) {
        joined = false;
        continue;
      }
      const yaw = recording.yaw[cell] as number;
      const at = vertices.length / FLOATS;
      for (const side of [1, -1])
        vertices.push(
          x,
          y,
          -side * Math.sin(yaw),
          side * Math.cos(yaw),
          step * recording.stepLength,
          red,
          green,
          blue,
        );
      if (joined) indices.push(at - 2, at - 1, at, at - 1, at + 1, at);
      joined = true;
    }
  }
  const buffer = new Buffer({
    data: Float32Array.from(vertices.length ? vertices : Array(FLOATS * 3).fill(0)),
    usage: BufferUsage.VERTEX | BufferUsage.COPY_DST,
  });
  const stride = FLOATS * 4;
  return new Geometry({
    attributes: {
      aPosition: { buffer, format: "float32x2", stride, offset: 0 },
      aNormal: { buffer, format: "float32x2", stride, offset: 8 },
      aTime: { buffer, format: "float32", stride, offset: 16 },
      aColour: { buffer, format: "float32x3", stride, offset: 20 },
    },
    indexBuffer: new Uint32Array(indices.length ? indices : [0, 1, 2]),
  });
}
