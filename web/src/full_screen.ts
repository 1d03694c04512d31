// The 3-D view, or the picture, in place of all else.

/** Fills the window, and the screen where the browser lets a page do so. `changed` is told whether it does. */
export class FullScreen {
  private isOn = false;

  constructor(private readonly changed: (isOn: boolean) => void) {
    document.addEventListener('fullscreenchange', () => {
      if (!document.fullscreenElement) this.set(false);
    });
  }

  toggle(): void {
    const wanted = !this.isOn;
    this.set(wanted);
    // Phones may refuse; then the page still fills its window.
    if (wanted) document.documentElement.requestFullscreen?.().catch(() => undefined);
    else if (document.fullscreenElement) void document.exitFullscreen();
  }

  /** Leaves it; returns whether there was something to leave. */
  leave(): boolean {
    if (!this.isOn) return false;
    this.toggle();
    return true;
  }

  private set(isOn: boolean): void {
    this.isOn = isOn;
    document.body.classList.toggle('full-screen', isOn);
    this.changed(isOn);
  }
}
