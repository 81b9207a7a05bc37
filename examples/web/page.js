// Shows the module that `vol compile` wrote, with a slider for each param and for time.
//
// tornado.wgsl  the shader; its entry points `cover` and `paint` draw a picture
// tornado.json  what `--reflect` says of it
// frames.json   contents of its buffers at moments and params, by `make`: in between they are interpolated

import { contents } from './frames.js';

const said = document.getElementById('said');
const fetched = async (name) => (await fetch(name)).json();

async function start() {
  if (!navigator.gpu) throw new Error('this browser has no WebGPU');
  const [reflection, frames] = await Promise.all([fetched('tornado.json'), fetched('frames.json')]);
  const code = await (await fetch('tornado.wgsl')).text();
  const adapter = await navigator.gpu.requestAdapter();
  if (!adapter) throw new Error('this browser finds no graphics device');
  const device = await adapter.requestDevice();
  const picture = await drawing(device, code, reflection);
  const values = sliders(frames, show);
  const play = document.getElementById('play');
  let queued = false;

  function show() {
    if (queued) return;
    queued = true;
    requestAnimationFrame(async () => {
      queued = false;
      picture.draw(contents(frames, values));
      await device.queue.onSubmittedWorkDone();
      if (play.checked) {
        values.step('time', 0.05);
        show();
      }
    });
  }
  play.onchange = show;
  const began = performance.now();
  picture.draw(contents(frames, values));
  await device.queue.onSubmittedWorkDone();
  said.textContent = `${reflection.moment.size.join(' x ')} on ${adapter.info.vendor} ${adapter.info.architecture}, ` +
    `pipeline in ${Math.round(picture.milliseconds)} ms, first picture in ${Math.round(performance.now() - began)} ms`;
}

/// The pipeline, its buffers and its canvas.
async function drawing(device, code, reflection) {
  const canvas = document.getElementById('picture');
  [canvas.width, canvas.height] = reflection.moment.size;
  const context = canvas.getContext('webgpu');
  // The shader gives linear light; a view in sRGB encodes it.
  const format = navigator.gpu.getPreferredCanvasFormat();
  const view = `${format}-srgb`;
  context.configure({ device, format, viewFormats: [view] });
  // `paint` reads all buffers but the last, which is the output of `render`.
  const inputs = reflection.bindings.slice(0, -1);
  const type = { 'uniform': 'uniform', 'storage, read': 'read-only-storage' };
  const layout = device.createBindGroupLayout({
    entries: inputs.map(({ binding, space }) =>
      ({ binding, visibility: GPUShaderStage.FRAGMENT, buffer: { type: type[space] } })),
  });
  const module = device.createShaderModule({ code });
  const began = performance.now();
  const pipeline = await device.createRenderPipelineAsync({
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
    vertex: { module, entryPoint: 'cover' },
    fragment: { module, entryPoint: 'paint', targets: [{ format: view }] },
  });
  const milliseconds = performance.now() - began;
  const usage = { 'uniform': GPUBufferUsage.UNIFORM, 'storage, read': GPUBufferUsage.STORAGE };
  const buffers = inputs.map(({ space, bytes }) =>
    device.createBuffer({ size: Math.max(bytes, 4096), usage: usage[space] | GPUBufferUsage.COPY_DST }));
  const group = device.createBindGroup({
    layout,
    entries: buffers.map((buffer, binding) => ({ binding, resource: { buffer } })),
  });
  inputs.forEach(({ words }, i) => device.queue.writeBuffer(buffers[i], 0, new Uint32Array(words)));

  function draw(words) {
    for (const [name, data] of words) {
      device.queue.writeBuffer(buffers[inputs.findIndex((input) => input.name === name)], 0, data);
    }
    const encoder = device.createCommandEncoder();
    const target = context.getCurrentTexture().createView({ format: view });
    const pass = encoder.beginRenderPass({
      colorAttachments: [{ view: target, loadOp: 'clear', storeOp: 'store', clearValue: [0, 0, 0, 1] }],
    });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, group);
    pass.draw(3);
    pass.end();
    device.queue.submit([encoder.finish()]);
  }
  return { draw, milliseconds };
}

/// A slider for each axis of the frames; the result holds their values by name.
function sliders(frames, changed) {
  const values = {
    step(name, by) {
      const axis = frames.axes.find((axis) => axis.name === name);
      const [first, last] = [axis.values[0], axis.values.at(-1)];
      values[name] = values[name] + by > last ? first : values[name] + by;
      inputs[name].value = values[name];
      inputs[name].oninput();
    },
  };
  const inputs = {};
  for (const { name, label, values: places, start, whole } of [...frames.axes, frames.alone]) {
    const row = document.createElement('label');
    const input = Object.assign(document.createElement('input'),
      { type: 'range', min: places[0], max: places.at(-1), step: whole ? 1 : 'any', value: start });
    const shown = document.createElement('output');
    const text = document.createElement('span');
    text.textContent = label;
    input.oninput = () => {
      values[name] = Number(input.value);
      shown.textContent = values[name].toFixed(whole ? 0 : 2);
      changed();
    };
    values[name] = start;
    shown.textContent = start.toFixed(whole ? 0 : 2);
    inputs[name] = input;
    row.append(text, input, shown);
    document.getElementById('sliders').append(row);
  }
  return values;
}

start().catch((error) => { said.textContent = String(error); });
