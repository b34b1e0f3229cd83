import type { Stage } from '../views/stage';

/** What the views show now as a PNG, on the page's own background, with the line between two points and the landmarks if there are any. */
export async function picture(stage: Stage, overlay: SVGSVGElement): Promise<Blob> {
  const { canvas, element } = stage;
  const sheet = document.createElement('canvas');
  sheet.width = canvas.width;
  sheet.height = canvas.height;
  const context = sheet.getContext('2d');
  if (!context) throw new Error('this browser gives no canvas to draw the picture on');
  context.fillStyle = getComputedStyle(element).backgroundColor;
  context.fillRect(0, 0, sheet.width, sheet.height);
  // The drawing buffer lives only until this task ends.
  stage.draw();
  context.drawImage(canvas, 0, 0);
  drawOverlay(context, overlay, canvas.width / element.clientWidth);
  return new Promise((resolve, reject) => {
    sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('the picture could not be encoded'))), 'image/png');
  });
}

function drawOverlay(context: CanvasRenderingContext2D, overlay: SVGSVGElement, scale: number): void {
  for (const shape of overlay.querySelectorAll<SVGGraphicsElement>('.shown, .shown > *')) {
    context.setTransform(new DOMMatrix().scale(scale).multiply(shape.getCTM() ?? undefined));
    drawShape(context, shape);
  }
}

function drawShape(context: CanvasRenderingContext2D, shape: SVGGraphicsElement): void {
  const { fill, stroke, strokeWidth, opacity, font } = getComputedStyle(shape);
  context.fillStyle = fill;
  context.strokeStyle = stroke;
  context.lineWidth = parseFloat(strokeWidth);
  context.globalAlpha = parseFloat(opacity);
  context.beginPath();
  if (shape instanceof SVGLineElement) {
    context.moveTo(shape.x1.baseVal.value, shape.y1.baseVal.value);
    context.lineTo(shape.x2.baseVal.value, shape.y2.baseVal.value);
  } else if (shape instanceof SVGCircleElement) {
    context.arc(shape.cx.baseVal.value, shape.cy.baseVal.value, shape.r.baseVal.value, 0, 2 * Math.PI);
    if (fill !== 'none') context.fill();
  } else if (shape instanceof SVGTextElement) {
    Object.assign(context, { font, textAlign: 'center', textBaseline: 'middle' });
    context.fillText(shape.textContent, 0, 0);
    return;
  } else {
    return;
  }
  context.stroke();
}
