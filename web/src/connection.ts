import { Command, Frame, TextMessage, unpackFrame } from './protocol';

interface Listeners {
  /** Shows a frame; resolves when it is on the screen. */
  frame(frame: Frame): Promise<void>;
  text(message: TextMessage): void;
  connected(is: boolean): void;
  failed(why: string): void;
}

const FIRST_PAUSE_MS = 300;
const LONGEST_PAUSE_MS = 5000;

/** The stream of the program that served this page. When it breaks, it is opened again, also by a restarted program. */
export class Connection {
  private socket: WebSocket | null = null;
  private pauseMs = FIRST_PAUSE_MS;
  private newest: ArrayBuffer | null = null;
  private isShowing = false;

  constructor(private readonly listeners: Listeners) {
    this.open();
  }

  send(command: Command): void {
    this.sendText(JSON.stringify(command));
  }

  private sendText(text: string): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(text);
  }

  private open(): void {
    const address = new URL('stream', location.href);
    address.protocol = 'ws:';
    address.search = location.search;  // it carries the token
    const socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => {
      this.pauseMs = FIRST_PAUSE_MS;
      this.listeners.connected(true);
    };
    socket.onmessage = (event) => {
      if (typeof event.data === 'string') {
        this.listeners.text(JSON.parse(event.data) as TextMessage);
      } else {
        this.newest = event.data as ArrayBuffer;
        void this.showNewest();
      }
    };
    socket.onclose = () => {
      this.newest = null;  // the program that comes next may have another body
      this.listeners.connected(false);
      setTimeout(() => this.open(), this.pauseMs);
      this.pauseMs = Math.min(2 * this.pauseMs, LONGEST_PAUSE_MS);
    };
  }

  /** Shows one frame at a time and then asks for the next, so that a slow page sees fewer, not older ones. */
  private async showNewest(): Promise<void> {
    if (this.isShowing) return;
    this.isShowing = true;
    while (this.newest) {
      const message = this.newest;
      this.newest = null;
      try {
        await this.listeners.frame(await unpackFrame(message));
      } catch (error) {
        this.listeners.failed(`This frame cannot be shown: ${error instanceof Error ? error.message : error}`);
      }
      this.sendText('next');
    }
    this.isShowing = false;
  }
}
