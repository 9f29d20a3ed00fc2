// Widget of a notebook for anywidget: a page in a frame, whose answers become the state of the model. See docs/sharing.md.
export default {
  render({ model, el }) {
    const frame = document.createElement("iframe");
    const ask = (message) => frame.contentWindow?.postMessage({ ...message, follow: true }, "*");
    const listen = ({ data, source }) => {
      if (source !== frame.contentWindow || data?.softcradle !== "answer") return;
      model.set("state", data.state);
      model.save_changes();
    };
    const obey = (message) => ask({ softcradle: "set", ...message });
    frame.setAttribute("sandbox", "allow-scripts allow-popups allow-downloads");
    frame.style.cssText = `width: 100%; height: ${model.get("height")}px; border: 0`;
    frame.addEventListener("load", () => ask({ softcradle: "get" }));
    frame.srcdoc = model.get("text");
    window.addEventListener("message", listen);
    model.on("msg:custom", obey);
    el.append(frame);
    return () => {
      window.removeEventListener("message", listen);
      model.off("msg:custom", obey);
    };
  },
};
