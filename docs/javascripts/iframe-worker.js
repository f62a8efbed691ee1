// Search without a server: pages opened as files may start no workers, so a hidden frame runs the worker's script.
// The frame has what Material's search worker uses: postMessage, onmessage or "message" listeners, and importScripts.
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super();
      this.onmessage = this.onerror = null;
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.appendChild(frame);
      this.frame = frame.contentWindow;
      window.addEventListener("message", event => {
        if (event.source !== this.frame) return;
        const message = new MessageEvent("message", { data: event.data });
        this.dispatchEvent(message);
        if (this.onmessage) this.onmessage(message);
      });
      const prelude = `
        self.postMessage = data => parent.postMessage(data, "*");
        self.importScripts = (...urls) => urls.reduce((done, url) => done.then(() => new Promise((resolve, reject) => {
          const script = document.createElement("script");
          Object.assign(script, { src: url, onload: resolve, onerror: reject });
          document.body.appendChild(script);
        })), Promise.resolve());`;
      const page = this.frame.document;
      page.open();
      page.write(`<body><script>${prelude}</script><script src="${new URL(url, location.href)}"></script></body>`);
      page.close();
    }

    postMessage(data) {
      const send = () => this.frame.dispatchEvent(new this.frame.MessageEvent("message", { data }));
      const deliver = () => (this.frame.document.readyState === "complete" ? send() : setTimeout(deliver, 20));
      deliver();
    }

    terminate() {
      this.frame.frameElement.remove();
    }
  };
  window.Worker = window.IFrameWorker;
}
