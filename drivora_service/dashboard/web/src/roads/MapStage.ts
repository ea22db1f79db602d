import "pixi.js/unsafe-eval";
import "pixi.js/browser";
import { Container, WebGLRenderer } from "pixi.js";
import { type Camera, cameraOf, type Size, toWorld, zoomAt } from "./camera";
import type { Palette } from "./palette";

type CameraListener = (camera: Camera, byHand: boolean) => void;
type PlaceListener = (x: number, y: number, event: PointerEvent) => void;

/** What is dragged instead of the map. */
export interface Grip {
  readonly move: (x: number, y: number, event: PointerEvent) => void;
  readonly drop: () => void;
  /** The browser took the gesture over. */
  readonly cancel: () => void;
}

const CLICK_PX = 4;
const WHEEL = 0.0015;

/** A canvas with a camera. It draws when something has changed, and rests otherwise. */
export class MapStage {
  /** Metres, y up. */
  readonly world = new Container({ isRenderGroup: true });
  /** Pixels, y down: what keeps its size when the camera comes nearer. */
  readonly screen = new Container();
  /** Called before each frame with the camera. */
  beforeDraw: ((camera: Camera, size: Size) => void) | undefined;
  afterDraw: (() => void) | undefined;
  onCamera: CameraListener | undefined;
  onHover: PlaceListener | undefined;
  onLeave: (() => void) | undefined;
  onClick: PlaceListener | undefined;
  /** Returns what is dragged from a place; undefined drags the map. */
  onGrab: ((x: number, y: number, event: PointerEvent) => Grip | undefined) | undefined;
  /** Called when the reader begins to drag the map. */
  onDrag: (() => void) | undefined;
  /** Whether the wheel comes nearer to the middle, not to the pointer. */
  holdsMiddle = false;

  private readonly root = new Container();
  private readonly renderer = new WebGLRenderer();
  private readonly watcher: ResizeObserver;
  private readonly stop = new AbortController();
  private frame = 0;
  private ready = false;
  private gone = false;
  private shown: Camera = { x: 0, y: 0, scale: 1 };
  private px: Size = { width: 1, height: 1 };
  private held:
    | { x: number; y: number; camera: Camera; moved: boolean; grip: Grip | undefined }
    | undefined;

  private constructor(private readonly frameElement: HTMLElement) {
    this.root.addChild(this.world, this.screen);
    this.watcher = new ResizeObserver(() => this.resize());
  }

  /** Makes a stage in an element; `destroy` it when the element goes. */
  static async make(element: HTMLElement, palette: Palette): Promise<MapStage> {
    const stage = new MapStage(element);
    await stage.renderer.init({
      width: Math.max(element.clientWidth, 1),
      height: Math.max(element.clientHeight, 1),
      background: palette.ground,
      antialias: true,
      autoDensity: true,
      resolution: Math.min(window.devicePixelRatio || 1, 2),
      skipExtensionImports: true,
    });
    if (stage.gone) {
      stage.renderer.destroy();
      return stage;
    }
    stage.ready = true;
    element.prepend(stage.canvas);
    stage.listen();
    stage.watcher.observe(element);
    stage.resize();
    return stage;
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.canvas as HTMLCanvasElement;
  }

  get isGone(): boolean {
    return this.gone;
  }

  get camera(): Camera {
    return this.shown;
  }

  get size(): Size {
    return this.px;
  }

  set background(colour: number) {
    this.renderer.background.color = colour;
    this.draw();
  }

  look(camera: Camera, byHand = false): void {
    this.shown = camera;
    this.draw();
    this.onCamera?.(camera, byHand);
  }

  /** Shows a box; `byHand` tells whether the reader asked for it. */
  fit(box: readonly [number, number, number, number], byHand = true, nearest?: number): void {
    this.look(cameraOf(box, this.px, 28, nearest), byHand);
  }

  zoom(factor: number): void {
    this.look(zoomAt(this.shown, this.px, this.px.width / 2, this.px.height / 2, factor), true);
  }

  /** Asks for a frame; several calls make one. */
  draw(): void {
    if (this.frame || this.gone) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.drawNow();
    });
  }

  drawNow(): void {
    if (!this.ready || this.gone) return;
    const { x, y, scale } = this.shown;
    this.world.scale.set(scale, -scale);
    this.world.position.set(this.px.width / 2 - x * scale, this.px.height / 2 + y * scale);
    this.beforeDraw?.(this.shown, this.px);
    this.renderer.render(this.root);
    this.afterDraw?.();
  }

  destroy(): void {
    if (this.gone) return;
    this.gone = true;
    cancelAnimationFrame(this.frame);
    this.stop.abort();
    this.watcher.disconnect();
    if (!this.ready) return;
    this.canvas.remove();
    this.root.destroy({ children: true });
    this.renderer.destroy();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.frameElement;
    if (!width || !height) return;
    this.px = { width, height };
    this.renderer.resize(width, height);
    // A changed canvas is empty until it is drawn.
    this.drawNow();
  }

  private listen(): void {
    const canvas = this.canvas;
    const { signal } = this.stop;
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const factor = Math.exp(-event.deltaY * WHEEL * (event.deltaMode === 1 ? 16 : 1));
        if (this.holdsMiddle) this.zoom(factor);
        else this.look(zoomAt(this.shown, this.px, event.offsetX, event.offsetY, factor), true);
      },
      { signal, passive: false },
    );
    canvas.addEventListener(
      "pointerdown",
      (event) => {
        if (event.button !== 0) return;
        canvas.setPointerCapture(event.pointerId);
        const at = toWorld(this.shown, this.px, event.offsetX, event.offsetY);
        const grip = this.onGrab?.(...at, event);
        const { clientX: x, clientY: y } = event;
        this.held = { x, y, camera: this.shown, moved: false, grip };
      },
      { signal },
    );
    canvas.addEventListener("pointermove", (event) => this.moved(event), { signal });
    canvas.addEventListener(
      "pointerup",
      (event) => {
        const held = this.held;
        this.held = undefined;
        if (held?.moved) held.grip?.drop();
        else if (held) this.tell(this.onClick, event);
      },
      { signal },
    );
    // A gesture that the browser takes over ends without a pointer going up.
    for (const end of ["pointercancel", "lostpointercapture"])
      canvas.addEventListener(
        end,
        () => {
          const held = this.held;
          this.held = undefined;
          if (held?.moved) held.grip?.cancel();
        },
        { signal },
      );
    canvas.addEventListener("pointerleave", () => this.onLeave?.(), { signal });
  }

  private moved(event: PointerEvent): void {
    const held = this.held;
    if (!held) {
      this.tell(this.onHover, event);
      return;
    }
    const dx = event.clientX - held.x;
    const dy = event.clientY - held.y;
    if (!held.moved) {
      if (Math.hypot(dx, dy) < CLICK_PX) return;
      held.moved = true;
      if (!held.grip) this.onDrag?.();
    }
    if (held.grip) {
      const [x, y] = toWorld(this.shown, this.px, event.offsetX, event.offsetY);
      held.grip.move(x, y, event);
      return;
    }
    const { x, y, scale } = held.camera;
    this.look({ x: x - dx / scale, y: y + dy / scale, scale }, true);
  }

  private tell(listener: PlaceListener | undefined, event: PointerEvent): void {
    if (!listener) return;
    const [x, y] = toWorld(this.shown, this.px, event.offsetX, event.offsetY);
    listener(x, y, event);
  }
}
