#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of `opcflow report` in a browser: the numbers of the page against the files of the
run folders, read by Python, and the effects of pointer and keyboard. Skipped without Chromium."""
import base64
import csv
import json
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import urllib.request
import zlib

SOURCE = os.environ['OPCFLOW_SOURCE']
COMMAND = os.path.join(os.environ['OPCFLOW_BUILD'], 'opcflow')
EVIL = '</script><img src=x onerror=alert(1)>'
LONG = 120  # s; a loaded machine is slow
BROWSERS = ('chromium', 'chromium-browser', 'google-chrome')


# ---- the browser ----

class Browser:
    """A tab of a headless Chromium, by the DevTools protocol over a plain WebSocket."""

    def __init__(self, path, folder):
        options = ['--headless', '--disable-gpu', '--remote-debugging-port=0', '--no-first-run',
                   '--window-size=1400,1000', '--user-data-dir=' + folder]
        if os.geteuid() == 0:
            options.append('--no-sandbox')
        self.process = subprocess.Popen([path, *options, 'about:blank'], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        port_file = os.path.join(folder, 'DevToolsActivePort')
        self.events, self.number = [], 0
        end = time.monotonic() + LONG
        while not (os.path.exists(port_file) and os.path.getsize(port_file)):
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError('the browser does not start')
            time.sleep(0.1)
        port = int(open(port_file).readline())
        pages = json.load(urllib.request.urlopen('http://127.0.0.1:%d/json' % port))
        self.connect(port, next(p for p in pages if p['type'] == 'page')['webSocketDebuggerUrl'])
        for domain in ('Runtime', 'Log', 'Page'):
            self.call(domain + '.enable')

    def connect(self, port, url):
        self.socket = socket.create_connection(('127.0.0.1', port), timeout=LONG)
        path = '/' + url.split('/', 3)[3]
        self.socket.sendall(('GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\n'
                             'Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n'
                             'Sec-WebSocket-Version: 13\r\n\r\n' % (path, port)).encode())
        answer = b''
        while b'\r\n\r\n' not in answer:
            answer += self.socket.recv(1)

    def receive(self, size):
        parts = b''
        while len(parts) < size:
            part = self.socket.recv(size - len(parts))
            if not part:
                raise EOFError('the browser has gone')
            parts += part
        return parts

    def message(self):
        """Return the next text of the browser, which may consist of fragments."""
        text = b''
        while True:
            head, size = self.receive(2)
            size &= 127
            if size > 125:
                size = int.from_bytes(self.receive(2 if size == 126 else 8), 'big')
            text += self.receive(size)
            if head & 128:
                return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        text = json.dumps({'id': self.number, 'method': method, 'params': parameters}).encode()
        size = bytes([128 + len(text)]) if len(text) < 126 else (
            b'\xfe' + len(text).to_bytes(2, 'big') if len(text) < 65536 else b'\xff' + len(text).to_bytes(8, 'big'))
        self.socket.sendall(b'\x81' + size + b'\0\0\0\0' + text)
        while True:
            answer = self.message()
            if answer.get('id') == self.number:
                if 'error' in answer:
                    raise RuntimeError(method + ': ' + answer['error']['message'])
                return answer['result']
            self.events.append(answer)

    def value(self, expression):
        answer = self.call('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True)
        if 'exceptionDetails' in answer:
            raise RuntimeError(json.dumps(answer['exceptionDetails'])[:400])
        return answer['result'].get('value')

    def until(self, expression):
        end = time.monotonic() + LONG
        while not self.value(expression):
            if time.monotonic() > end:
                raise RuntimeError('never true: ' + expression)
            time.sleep(0.05)

    def open(self, path):
        self.call('Page.navigate', url='file://' + path)
        self.until('document.documentElement?.dataset.ready === "1" &&'
                   ' (!document.querySelector(".viewer") || !!document.querySelector(".viewer").dataset.scale)')

    def mouse(self, kind, x, y, **more):
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, **more)

    def key(self, name, code=0):
        self.call('Input.dispatchKeyEvent', type='keyDown', key=name, windowsVirtualKeyCode=code)
        self.call('Input.dispatchKeyEvent', type='keyUp', key=name, windowsVirtualKeyCode=code)
        self.settle()

    def settle(self):
        self.value('new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))')

    def faults(self):
        """Return messages of the console, the policy and dialogs, without those of this test's read-backs."""
        bad = [e for e in self.events if e['method'] in ('Runtime.exceptionThrown', 'Page.javascriptDialogOpening')
               or e['method'] == 'Runtime.consoleAPICalled' and e['params']['type'] in ('error', 'warning')
               or e['method'] == 'Log.entryAdded' and e['params']['entry']['level'] in ('error', 'warning')]
        bad = [text for text in map(json.dumps, bad) if 'readback' not in text]
        return ' '.join(bad)[:600]

    def close(self):
        self.process.terminate()
        self.process.wait(20)


# ---- reference values ----

def unpack(text, stride):
    raw = zlib.decompress(base64.b64decode(text))
    numbers = list(struct.unpack('<%di' % (len(raw) // 4), raw))
    for i in range(stride, len(numbers)):
        numbers[i] += numbers[i - stride]
    return numbers


class Run:
    def __init__(self, folder):
        self.metrics = {step + '.' + name: m['value']
                        for step, all_of in json.load(open(folder + '/metrics.json')).items()
                        if isinstance(all_of, dict) for name, m in all_of.items()}
        rows = list(csv.reader(open(folder + '/gates.csv', newline='')))
        names = [c.split(' (')[0] for c in rows[0]]
        self.gates = [dict(zip(names, row)) for row in rows[1:]]
        self.view = json.load(open(folder + '/view.json'))
        self.boxes = unpack(self.view['boxes'], 4)

    def centre(self, i):
        x0, y0, x1, y1 = (v * self.view['grid'] for v in self.boxes[4 * i:4 * i + 4])
        return (x0 + x1) / 2, (y0 + y1) / 2

    def worst(self):
        return sorted(range(len(self.gates)), key=lambda i: -abs(float(self.gates[i]['ion_after'])))


def opcflow(*words):
    return subprocess.run([COMMAND, *words], capture_output=True, text=True)


def make_runs(folder):
    """Make two runs of a cell; all texts of the second run contain markup."""
    for name, more in (('one', []), ('two', ['--set', 'mask.max_iterations=2', '--set', 'require=~'])):
        done = opcflow('run', SOURCE + '/flows/demo.yaml', '--output', folder + '/' + name, '--set', 'picture=~', *more)
        if done.returncode > 1:
            raise RuntimeError(done.stderr)
    two = folder + '/two/'
    rows = list(csv.reader(open(two + 'gates.csv', newline='')))
    for i, row in enumerate(rows[1:]):
        row[0], row[1] = EVIL + ':%d' % (i + 1), EVIL
    csv.writer(open(two + 'gates.csv', 'w', newline='')).writerows(rows)
    view = json.load(open(two + 'view.json'))
    view['cell'] = EVIL
    json.dump(view, open(two + 'view.json', 'w'))
    done = opcflow('report', folder + '/one', two, '--output', folder + '/page.html', '--title', 'Two of ' + EVIL)
    if done.returncode:
        raise RuntimeError(done.stderr)


def make_experiment(folder):
    """Make an experiment: the two runs as methods on a case, and a second case with one run and one
    failure. A third method has the transistors of the first one."""
    top = folder + '/experiment/'
    for case, name in (('A', 'one'), ('A', 'two'), ('B', 'one')):
        shutil.copytree(folder + '/' + name, top + case + '/' + name)
    shutil.copytree(folder + '/one', top + 'A/three')
    rows = [['case', 'method', 'folder', 'result', 'seconds (s)'],
            ['A', 'one', 'A/one', 'complete', '1'], ['A', 'two', 'A/two', 'complete', '1'],
            ['A', 'three', 'A/three', 'complete', '1'],
            ['B', 'one', 'B/one', 'complete', '1'], ['B', 'two', '', 'no litho ' + EVIL, '0']]
    csv.writer(open(top + 'experiment.csv', 'w', newline='')).writerows(rows)
    done = opcflow('report', top, '--output', folder + '/experiment.html')
    if done.returncode:
        raise RuntimeError(done.stderr)


# ---- tests ----

def expect(found, wanted, what):
    if found != wanted:
        raise AssertionError('%s: %r, not %r' % (what, found, wanted))


def test_numbers(b, runs):
    """Test that all numbers of the tables equal those of metrics.json, bit by bit."""
    cells = b.value('''[...document.querySelectorAll('#facts td[data-metric]')].map(c => [c.dataset.metric, c.dataset.value])''')
    expect(len(cells) >= 2 * len(runs[0].metrics), True, 'cells of all metrics')
    for k, (name, value) in enumerate(cells):
        known = runs[k % 2].metrics.get(name)
        if known is not None and float(value) != known:
            raise AssertionError('%s: %s, not %r' % (name, value, known))
    shown = b.value('''document.querySelector('#summary td[data-metric="mask.ion_max"]').textContent''')
    expect(abs(float(shown) / runs[0].metrics['mask.ion_max'] - 1) < 1e-3, True, 'largest deviation, ' + shown)


def test_data(b, runs):
    """Test that the embedded figures equal those of gates.csv."""
    text = b.value('document.getElementById("data").textContent')
    data = json.loads(text)
    columns = {c['name']: c['values'] for c in data['runs'][0]['tables']['gates']['columns']}
    expect(columns['ion_after'], [float(g['ion_after']) for g in runs[0].gates], 'ion_after')
    expect(columns['transistor'], [g['transistor'] for g in runs[0].gates], 'names')
    expect(data['runs'][0]['view'], runs[0].view, 'view')
    expect(data['runs'][1]['view']['cell'], EVIL, 'cell')


def window(b):
    return b.value('''(({x, y, scale}) => ({x: +x, y: +y, scale: +scale}))(document.querySelector('.viewer').dataset)''')


def place(b, pane, at):
    """Return the position on the screen of a place of the layout."""
    b.value('document.querySelector(".panes").scrollIntoView({block: "center"})')
    r = b.value('''(r => ({x: r.x + r.width / 2, y: r.y + r.height / 2}))
        (document.querySelectorAll('.pane canvas')[%d].getBoundingClientRect())''' % pane)
    w = window(b)
    return r['x'] + (at[0] - w['x']) * w['scale'], r['y'] - (at[1] - w['y']) * w['scale']


def test_pointing(b, runs):
    run = runs[0]
    for i in range(len(run.gates)):
        b.mouse('mouseMoved', *place(b, 1, run.centre(i)))
        b.settle()
        shown = b.value('''document.querySelector('.tip').hidden ? '' : document.querySelector('.tip').innerText''')
        for text in (run.gates[i]['transistor'], run.gates[i]['cell']):
            expect(text in shown, True, 'tip %r of %s' % (shown, text))
        facts = b.value('''Object.fromEntries([...document.querySelectorAll('.tip .facts div')].map(d =>
            [d.firstChild.textContent, d.lastChild.textContent]))''')
        found = float(facts['ΔIon'].replace('\u2212', '-').split('\u202f')[0])
        expect(abs(found - float(run.gates[i]['ion_after'])) < 5e-4, True, 'Ion ' + facts['ΔIon'])


def test_colours(b, runs):
    """Test that transistors with a low Ion are blue, and those with a high Ion red."""
    run, b0 = runs[0], b
    b0.mouse('mouseMoved', 2, 2)
    for i in run.worst()[:2]:
        b0.value('document.querySelector("input[data-role=drawn]").checked || 1')
        pixel = b0.value('''(([x, y]) => { const c = document.querySelectorAll('.pane canvas')[0], r = c.getBoundingClientRect();
            return [...c.getContext('2d').getImageData((x - r.x) * c.width / r.width, (y - r.y) * c.height / r.height, 1, 1).data]; })(%s)'''
                         % json.dumps(place(b0, 0, run.centre(i))))
        weak = float(run.gates[i]['ion_before']) < 0
        expect((pixel[2] > pixel[0]), weak, 'colour %r of %s' % (pixel, run.gates[i]['ion_before']))


def test_zoom(b, runs):
    before = window(b)
    x, y = place(b, 1, runs[0].centre(0))
    b.mouse('mouseWheel', x, y, deltaX=0, deltaY=-400)
    b.settle()
    after = window(b)
    expect(after['scale'] > 1.5 * before['scale'], True, 'scale %g after %g' % (after['scale'], before['scale']))
    there = place(b, 1, runs[0].centre(0))
    expect(abs(there[0] - x) + abs(there[1] - y) < 2, True, 'what is under the pointer stays: %r' % (there,))
    b.mouse('mousePressed', x, y, button='left', clickCount=1)
    b.mouse('mouseMoved', x + 40, y + 10, button='left', buttons=1)
    b.mouse('mouseReleased', x + 40, y + 10, button='left')
    b.settle()
    moved = window(b)
    expect(round((after['x'] - moved['x']) * after['scale']), 40, 'drag to the right')
    expect(round((moved['y'] - after['y']) * after['scale']), 10, 'drag downwards')


def test_keyboard(b, runs):
    run = runs[0]
    b.value('document.querySelectorAll(".pane canvas")[1].focus()')
    b.key('0', 48)
    details = '''document.getElementById('details').innerText'''
    for rank, i in enumerate(run.worst()[:3]):
        b.key('PageDown', 34)
        expect(run.gates[i]['transistor'] in b.value(details), True, 'rank %d: %s' % (rank, b.value(details)))
    b.key('Escape', 27)
    expect(b.value(details), '', 'after Escape')
    b.key('0', 48)
    seen = set()
    for name, code in (('ArrowLeft', 37), ('ArrowUp', 38), ('ArrowRight', 39), ('ArrowDown', 40)):
        b.key(name, code)
        seen.add(b.value(details))
    expect(len(seen - {''}) >= 3, True, 'transistors reached: %r' % seen)
    scale = window(b)['scale']
    b.key('+', 187)
    expect(window(b)['scale'] > scale, True, 'nearer')


def test_compare(b, runs):
    """Test two runs side by side: the third picture is the difference."""
    b.value('''(s => { s.value = '1'; s.dispatchEvent(new Event('change')); })(document.getElementById('beside'))''')
    b.until('''document.querySelectorAll('.pane h4')[2].textContent.includes(' less ')''')
    b.value('''(s => { s.value = ''; s.dispatchEvent(new Event('change')); })(document.getElementById('beside'))''')


def test_texts(b, runs):
    """Test that no text of the data has become an element."""
    expect(b.value('document.images.length'), 0, 'images')
    expect(EVIL in b.value('document.querySelector("h1").textContent'), True, 'the title')


def test_themes(b, runs):
    light = '''getComputedStyle(document.body).backgroundColor'''
    seen = []
    for theme in ('light', 'dark'):
        b.value('''(s => { s.value = '%s'; s.dispatchEvent(new Event('change')); })(document.getElementById('theme'))''' % theme)
        b.settle()
        corner = b.value('''[...document.querySelector('.pane canvas').getContext('2d').getImageData(3, 3, 1, 1).data].slice(0, 3)''')
        seen.append((b.value(light), 'rgb(%d, %d, %d)' % tuple(corner)))
    for body, canvas in seen:
        expect(canvas, body, 'the paper of the pictures')
    expect(seen[0][0] != seen[1][0], True, 'two themes')
    b.value('''(s => { s.value = ''; s.dispatchEvent(new Event('change')); })(document.getElementById('theme'))''')


def test_narrow(b, runs):
    b.call('Emulation.setDeviceMetricsOverride', width=390, height=800, deviceScaleFactor=2, mobile=True)
    b.settle()
    wide = b.value('document.scrollingElement.scrollWidth')
    b.call('Emulation.clearDeviceMetricsOverride')
    expect(wide <= 390, True, 'width of the page on a telephone, %d' % wide)


def test_experiment(b, runs, folder):
    """Test the means over all cases against those computed by Python; the page lists failed cases."""
    make_experiment(folder)
    b.open(folder + '/experiment.html')
    rows = b.value('''[...document.querySelectorAll('#summary > .wide table')[0].rows].map(r => [...r.cells].map(c => c.innerText.trim()))''')
    expect([r[0] for r in rows[1:]], ['one', 'two', 'three'], 'methods')
    verdicts = b.value("""[...document.querySelectorAll('#summary .note')].filter(n =>
        n.firstChild.innerText === 'Verdicts').map(n => n.innerText.split('\\n').slice(1))""")
    expect(verdicts, [['no verdict on three against one; equal in Ion, Ioff, area, shots, violations, seconds']], 'verdicts')
    ion = [abs(float(g['ion_after'])) for g in runs[0].gates]
    expect(int(rows[1][1]), 2 * len(ion), 'transistors')
    at = [k for k, name in enumerate(rows[0]) if name.startswith('mean |ΔIon|')][0]
    expect(abs(float(rows[1][at]) - sum(ion) / len(ion)) < 1e-3 * max(ion), True, 'mean, ' + rows[1][at])
    expect('B, two: no litho ' + EVIL in b.value('document.getElementById("summary").innerText'), True, 'the failure')
    b.open(folder + '/page.html')


def test_other_steps(b, runs, folder):
    """Test the table of other steps: only figures that differ and have a direction."""
    figures = {'margin': ('higher', 5, 7.25), 'equal': ('higher', 3, 3), 'any': ('neutral', 1, 2)}
    copies = []
    for k, name in enumerate(('one', 'two')):
        copies.append(shutil.copytree(folder + '/' + name, folder + '/circuit-' + name))
        metrics = json.load(open(copies[k] + '/metrics.json'))
        metrics['circuit'] = {m: {'value': v[1 + k], 'unit': 'mV', 'better': v[0], 'tolerance': 0} for m, v in figures.items()}
        json.dump(metrics, open(copies[k] + '/metrics.json', 'w'))
    done = opcflow('report', *copies, '--output', folder + '/circuit.html')
    expect(done.returncode, 0, done.stderr)
    b.open(folder + '/circuit.html')
    rows = b.value("""[...document.querySelectorAll('#summary table')].filter(t =>
        t.caption.innerText.startsWith('Figures of other steps')).map(t => [...t.rows].map(r => [...r.cells].map(c => c.innerText.trim())))""")
    expect(len(rows), 1, 'tables')
    expect([r for r in rows[0] if r[0].startswith('circuit')], [['circuit.margin', 'mV', 'higher', '5', '7.25']], 'figures')
    expect([r[0] for r in rows[0] if r[0].startswith(('mask', 'cost'))], [], 'figures of the correction')
    b.open(folder + '/page.html')


def test_few(b, runs, folder):
    """Test one transistor (no spread), no transistors, empty figures, and figures that are all 0."""
    def change(name, table, edit):
        rows = list(csv.reader(open(folder + '/one/' + table, newline='')))
        target = folder + '/' + name
        shutil.copytree(folder + '/one', target)
        os.unlink(target + '/view.json')
        csv.writer(open(target + '/' + table, 'w', newline='')).writerows(edit(rows))
        done = opcflow('report', target, '--output', target + '.html')
        expect(done.returncode, 0, name + done.stderr)
        b.open(target + '.html')
        expect(b.value("document.querySelectorAll('svg [d*=NaN], svg [d*=Infinity], svg [cx*=Infinity]').length"), 0, name)
        expect(b.faults(), '', name)

    def without(rows, words, value):
        gone = [any(w in name for w in words) for name in rows[0]]
        return rows[:1] + [[value if g else v for g, v in zip(gone, row)] for row in rows[1:]]
    change('single', 'gates.csv', lambda rows: rows[:2])
    change('nobody', 'gates.csv', lambda rows: rows[:1])
    change('failing', 'gates.csv', lambda rows: without(rows, ('before', 'after'), ''))
    change('equal', 'gates.csv', lambda rows: without(rows, ('before', 'after'), '0'))
    change('exact', 'history.csv', lambda rows: without(rows, ('ion', 'area', 'epe'), '0'))
    b.open(folder + '/page.html')


def test_print(b, runs):
    pdf = base64.b64decode(b.call('Page.printToPDF', printBackground=True)['data'])
    expect(pdf[:5], b'%PDF-', 'what is printed')
    expect(pdf.count(b'/Type /Page\n') + pdf.count(b'/Type /Page ') >= 2, True, 'pages')


def main():
    tests = [t for name, t in globals().items() if name.startswith('test_')]
    browser = next((p for p in map(shutil.which, BROWSERS) if p), None)
    if not browser:
        print('1..0 # SKIP Chromium is missing, so that the page is not tested (Debian package: chromium)')
        return 0
    failed = 0
    print('1..%d' % (len(tests) + 1), flush=True)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        make_runs(folder)
        runs = [Run(folder + '/one'), Run(folder + '/two')]
        b = Browser(browser, folder + '/profile')
        try:
            b.open(folder + '/page.html')
            for number, test in enumerate(tests, 1):
                try:
                    test(*(b, runs, folder)[:test.__code__.co_argcount])
                    print('ok %d %s' % (number, test.__name__), flush=True)
                except (AssertionError, RuntimeError) as fault:
                    failed = 1
                    print('not ok %d %s\n# %s' % (number, test.__name__, str(fault)[:2000].replace('\n', ' ')), flush=True)
            faults = b.faults()
            failed |= bool(faults)
            print('%sok %d nothing in the console%s' % ('not ' if faults else '', len(tests) + 1, '\n# ' + faults if faults else ''))
        finally:
            b.close()
    return failed


if __name__ == '__main__':
    sys.exit(main())
