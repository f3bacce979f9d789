// Draws the graphs of this page. They come packed, and so does the library where the page carries it.
(async () => {
  const unpacked = async (id) => {
    const letters = atob(document.getElementById(id).textContent);
    const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Response(stream).text();
  };
  const figures = [...document.querySelectorAll('figure')];
  if (document.getElementById('library')) {
    const script = document.createElement('script');
    script.textContent = await unpacked('library');
    document.head.append(script);
  }
  if (!window.Plotly) {
    for (const figure of figures) figure.querySelector('div').textContent = figure.dataset.without;
    return;
  }
  const { axes, plots } = JSON.parse(await unpacked('graphs'));
  const button = (graph, format, height) => {
    const one = document.createElement('button');
    one.type = 'button';
    one.textContent = format.toUpperCase();
    one.onclick = () => Plotly.downloadImage(graph, { format, width: 900, height, filename: document.title });
    return one;
  };
  for (const [k, figure] of figures.entries()) {
    const graph = figure.querySelector('div');
    const { data, layout, config } = plots[k];
    const { height } = layout;
    for (const trace of data) trace.x = axes[trace.x];
    await Plotly.newPlot(graph, data, { ...layout }, config);
    figure.querySelector('figcaption').append(button(graph, 'svg', height), ' ', button(graph, 'png', height));
  }
  const redraw = (change) => figures.forEach((figure, k) => {
    Plotly.relayout(figure.querySelector('div'), change(plots[k].layout.height));
  });
  // A sheet of A4 between its margins, pixels.
  addEventListener('beforeprint', () => redraw((height) => ({ width: 680, height: Math.min(height, 950) })));
  addEventListener('afterprint', () => redraw((height) => ({ width: null, autosize: true, height })));
})();
