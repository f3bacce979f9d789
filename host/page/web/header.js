// How much of the window the header takes, for the style sheets: `--header`.

/** Measures the header, whenever it or the window changes; where it scrolls away, the style sheet's own value counts. */
export function measureHeader(header) {
  const { style } = document.documentElement;
  const measure = () => {
    if (getComputedStyle(header).position === 'sticky') style.setProperty('--header', `${header.offsetHeight}px`);
    else style.removeProperty('--header');
  };
  new ResizeObserver(measure).observe(header);
  addEventListener('resize', measure);
}
