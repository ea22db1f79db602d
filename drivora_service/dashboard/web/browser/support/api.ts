/** Requests to the service, as the tests compare the page with its answers. */

import { sleep } from "./service";

export class Api {
  constructor(
    readonly url: string,
    private readonly token = "",
  ) {}

  async get<Answer>(path: string): Promise<Answer> {
    return (await this.ask("GET", path)) as Answer;
  }

  async post<Answer>(path: string, content: unknown = undefined): Promise<Answer> {
    return (await this.ask("POST", path, content)) as Answer;
  }

  /** Asks again until an answer is as wanted. */
  async until<Answer>(path: string, wanted: (answer: Answer) => boolean): Promise<Answer> {
    const deadline = Date.now() + 480_000;
    for (;;) {
      const answer = await this.get<Answer>(path);
      if (wanted(answer)) return answer;
      if (Date.now() > deadline) throw new Error(`${path} stays ${JSON.stringify(answer)}`);
      await sleep(200);
    }
  }

  private async ask(method: string, path: string, content?: unknown): Promise<unknown> {
    const answer = await fetch(`${this.url}/api/v1${path}`, {
      method,
      headers: {
        ...(content === undefined ? {} : { "content-type": "application/json" }),
        ...(this.token ? { authorization: `Bearer ${this.token}` } : {}),
      },
      ...(content === undefined ? {} : { body: JSON.stringify(content) }),
    });
    const text = await answer.text();
    if (!answer.ok) throw new Error(`${method} ${path}: ${answer.status} ${text}`);
    return text ? JSON.parse(text) : undefined;
  }
}
