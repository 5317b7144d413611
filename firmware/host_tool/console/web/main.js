// SPDX-License-Identifier: MIT
// The controller's live page: what the server tells becomes pictures, words and the buttons that make sense.
import { ArmView } from './arm.js';
import { BlackBox } from './black_box.js';
import { Dials } from './dials.js';
import { Jog } from './jog.js';
import { adviceFor, markdown, possible, setAdvice, situation, troubleOf, upper } from './meaning.js';
import { duration, element, fixed, reading, readingWords, rough, tell } from './words.js';

const kOld_ms = 1500;       // news older than this is not shown as the present
const kMostLines = 200;
const kSure_ms = 4000;      // within which a second click confirms

const viewer = Array.from(crypto.getRandomValues(new Uint8Array(12)), (byte) => byte.toString(16).padStart(2, '0')).join('');
const byId = (id) => document.getElementById(id);
const arm = new ArmView(byId('arm'));
const dials = new Dials(byId('dials'));
const blackBox = new BlackBox(byId('black-box'), tell);
const jog = new Jog(byId('jog'), byId('jogs'), (values) => request('move', values));

let joints = [];
let verbs = {};      // of the controller: the modes of each, and whether nothing else may be under way
let rows = [];
let state = null;
let heard = 0;       // when the server was heard last
let shownAnswer = null;
let asked = '';      // the verb that was pressed and is not answered yet
let pausedBy = '';   // the name of what paused the measurement, as the controller said
let play = null;     // of the joints, as the controller reported it of the candidate

// --- What the server tells -------------------------------------------------------------------------

function rowOf(values) {
  return {
    sweep: Number(values.sweep),
    q: joints.map((joint, i) => reading(values, i + 1, joint.revolute)),
    p: ['x_mm', 'y_mm', 'z_mm'].map((key) => values[key] / 1e3),
  };
}

// The words key=value of a line.
const valuesOf = (line) => Object.fromEntries([...line.matchAll(/(\w+)=(\S+)/g)].map(([, key, value]) => [key, value]));

// The play of the joints; a new measurement has sweeps before it.
function takePlay(line) {
  if (line.startsWith('# identify swept')) play = null;
  if (line.startsWith('# identify backlash ')) play = valuesOf(line);
}

function listen() {
  const events = new EventSource(`events?viewer=${viewer}`);
  const on = (name, take) => events.addEventListener(name, (event) => {
    heard = performance.now();
    take(JSON.parse(event.data));
  });
  on('arm', (told) => {
    joints = told.joints;
    verbs = told.verbs;
    rows = [];
    arm.setArm(joints);
    dials.setArm(joints);
    jog.setArm(joints);
  });
  on('points', ({ from, points }) => {
    rows = rows.slice(0, from).concat(points.map(rowOf));
    arm.setRows(rows);
    if (state) dials.show(rows, state.sigmas, Number(state.status.sweep ?? 0));
  });
  on('said', (lines) => {
    for (const line of lines) pausedBy = /^# identify paused error=(\S+)/.exec(line)?.[1] ?? (line.startsWith('# identify ') ? '' : pausedBy);
    lines.forEach(takePlay);
    const bad = (line) => / error=|faulted|refused|ended|lost/.test(line);
    const items = lines.map((line) => element('li', bad(line) ? { class: 'bad' } : {}, line.replace(/^# /, '')));
    byId('said').prepend(...items.reverse());
    while (byId('said').childElementCount > kMostLines) byId('said').lastChild.remove();
  });
  on('state', (told) => {
    state = told;
    show();
  });
  // The browser tries again by itself unless it was refused; then we do.
  events.addEventListener('error', () => {
    if (events.readyState !== EventSource.CLOSED) return;
    events.close();
    setTimeout(listen, 1000);
  });
}

// --- What it means ---------------------------------------------------------------------------------

// Why what is shown is not the present; empty: it is.
function stale() {
  if (state === null || (state.linked && !state.status.mode)) return 'Connecting to the controller …';
  const silent = performance.now() - heard;
  if (silent > kOld_ms) return `The page’s server has gone: nothing heard for ${duration(silent / 1e3)}. What is shown is old.`;
  if (!state.linked) return `No connection to the controller: ${state.why}. What is shown is old.`;
  if (state.age_ms === null || state.age_ms + silent > kOld_ms) {
    return state.busy ? `The controller is busy with ${state.busy} …` : 'The controller does not answer. What is shown is old.';
  }
  return '';
}

// --- How it looks ----------------------------------------------------------------------------------

function showProgress({ status }) {
  const running = ['identifying', 'paused', 'checking'].includes(status.sequence);
  byId('progress').hidden = !running;
  if (!running) return;
  const [points, planned] = [Number(status.points), Number(status.planned)];
  byId('progress-fill').style.width = `${(100 * points) / Math.max(1, planned)}%`;
  byId('progress-track').setAttribute('aria-valuemax', planned);
  byId('progress-track').setAttribute('aria-valuenow', points);
  const beyond = points >= planned;
  const why = status.sweep ? ', until each axis is known' : '';
  tell('progress-points', beyond ? `${points} points: more than the ${planned} planned${why}` : `${points} of ${planned} points`);
  tell('progress-left', status.left_s && !beyond ? `${duration(Number(status.left_s))} left` : '');
}

function showVerdict({ candidate, status }) {
  const shown = candidate !== null && status.sequence === 'none' && status.mode !== 'faulted';
  byId('verdict').hidden = !shown;
  if (!shown) return;
  const [ours, theirs] = [Number(candidate.validation_rms_mm), Number(candidate.active_rms_mm)];
  const largest = Math.max(ours, theirs, 1e-9);
  byId('candidate-bar').style.width = `${(100 * ours) / largest}%`;
  byId('active-bar').style.width = `${(100 * theirs) / largest}%`;
  tell('candidate-rms', `${rough(ours)} mm`);
  tell('active-rms', `${rough(theirs)} mm`);
  tell('active-name', candidate.active === 'nominal' ? 'the nominal model' : `signature ${candidate.active}`);
}

function showFault({ status }) {
  const faulted = status.mode === 'faulted';
  byId('fault').hidden = !faulted;
  if (faulted) {
    const { happened, todo } = adviceFor(status.fault);
    tell('fault-happened', upper(markdown(happened ?? '')));
    tell('fault-todo', markdown(todo ?? ''));
    tell('fault-device', status.fault_says ? `The drive says: ${status.fault_says} (${status.fault_code})` : '');
  }
  blackBox.show(status.black_box ?? '', status.fault_joint);
}

// Every figure is of one reply, which names the signature that it is of: `status` the one in use, `candidate` the candidate.
function showFacts({ status, candidate, sigmas }) {
  const trouble = troubleOf(status, pausedBy);
  const facts = [['model', status.model]];
  if (trouble || status.sensor) facts.push(['sensor', trouble ? markdown(adviceFor(trouble).words ?? trouble) : 'answers']);
  if (status.sensor_says) facts.push(['sensor says', status.sensor_says]);
  if (status.store) facts.push(['store', markdown(adviceFor(status.store).words ?? status.store)]);
  if (status.torque_percent) facts.push(['torque by joint', `${status.torque_percent} %; in a sequence at most ${status.largest_torque_percent} %`]);
  if (status.limits_active) facts.push(['limited by its drive', `joint ${status.limits_active}`]);
  if (status.warning) facts.push(['its drive warns', `joint ${status.warning}`]);
  if (status.unsupervised) facts.push(['holds torque without this controller', `joint ${status.unsupervised}`]);
  if (status.unreferenced) facts.push(['may stand elsewhere than it reads', `joint ${status.unreferenced}: look at it, then confirm${verbs.home ? ', or home it' : ''}`]);
  if (status.signature) facts.push(['signature', [`number ${status.signature}`, ...accuracyOf(status), ...(status.air_c ? [`${status.air_c} \u00b0C`] : [])].join(', ')]);
  if (status.check) facts.push(['last check', status.check]);
  facts.push(...candidateFacts(status, candidate, sigmas));
  if (status.late_max_us) facts.push(['control tick', `at most ${rough(Number(status.late_max_us))} \u00b5s late`]);
  const key = JSON.stringify(facts);
  if (byId('facts').dataset.key === key) return;
  byId('facts').dataset.key = key;
  byId('facts').replaceChildren(...facts.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
}

const kRegions = { configuration: 'at the signature configuration', measured: 'over the readings measured', limits: 'over the joint limits' };

// What a reply tells of the accuracy of the signature that it names.
function accuracyOf(told, prefix = '') {
  const words = [];
  const predicted = told[`${prefix}predicted_tool_error_mm`];
  if (predicted) words.push(`${rough(Number(predicted))} mm RMS predicted ${kRegions[told[`${prefix}predicted_region`]] ?? ''}`);
  if (told.validation_rms_mm && !prefix) words.push(`${rough(Number(told.validation_rms_mm))} mm RMS on ${told.validation_poses ?? 'the'} validation poses`);
  return words;
}

// Of a measurement under way, and of what it found until that is accepted: its accuracy, and the play that it has seen.
function candidateFacts(status, candidate, sigmas) {
  const running = status.sequence === 'identifying' || status.sequence === 'paused';
  if (running) {
    if (status.candidate_predicted_tool_error_mm) return [['candidate', `${accuracyOf(status, 'candidate_')} so far, ${fixed(Number(status.asked_mm), 2)} mm asked for`]];
    const shares = dials.shares(sigmas).filter(Number.isFinite);
    return shares.length > 0 ? [['candidate', `tool \u00b1 ${rough(Math.hypot(...shares))} mm by ${shares.length} of ${joints.length} axes known so far`]] : [];
  }
  if (!candidate) return [];
  const asked = candidate.asked_mm ? [`${fixed(Number(candidate.asked_mm), 2)} mm asked for: ${candidate.reached === 'yes' ? 'reached' : 'not reached'}`] : [];
  const facts = [['candidate', [...accuracyOf(candidate), ...asked].join(', ')]];
  const size = (joint) => (joints[joint - 1]?.revolute ? `${rough(Number(play[`q${joint}_deg`]))}\u00b0` : `${rough(Number(play[`q${joint}_mm`]))} mm`);
  const seen = (play?.seen ?? '').split(',').filter((joint) => Number(joint) > 0);
  if (seen.length > 0) facts.push(['backlash', seen.map((joint) => `joint ${joint} ${size(joint)}`).join(', ')]);
  return facts;
}

function showReadings({ status }) {
  const parts = joints.map((joint, i) => element('span', {}, `${i + 1} `, element('b', {}, readingWords(status, i + 1, joint.revolute))));
  byId('readings').replaceChildren(...parts);
}

function showAnswer({ answer }) {
  if (answer === null || answer.number === shownAnswer) return;
  shownAnswer = answer.number;
  asked = '';
  const [, name, rest] = /^error (\S+) (.*)$/.exec(answer.words) ?? [];
  const own = / why="([^"]*)"/.exec(rest ?? '');  // of the controller, which knows more than the table of messages
  const why = own ? `${rest.replace(own[0], '')}: ${own[1]}` : name ? `${rest}. ${markdown(adviceFor(name).todo ?? '')}` : answer.words;
  say(answer.verb, answer.ok ? touchWords(answer) ?? `The controller took ${answer.verb}.` : `${answer.verb}: ${why}`, answer.ok);
}

// What the controller counts of touches.
function touchWords({ verb, words }) {
  const [, place, here, all] = / place=(\S+) at_place=(\d+) touches=(\d+)/.exec(words) ?? [];
  if (!place) return null;
  const [, left, next] = / left=(\d+)(?: next=(\S+))?/.exec(words) ?? [];
  const plan = left ? `, ${left} left of the plan${next ? `, next ${next}` : ''}` : '';
  return `${verb === 'touch' ? 'Touched' : 'Dropped a touch of'} ${place}: ${here} there, ${all} in all${plan}.`;
}

// What became of a request; of a jog beside its buttons, too.
function say(verb, words, good) {
  for (const id of verb === 'move' ? ['answer', 'jog-answer'] : ['answer']) tell(id, words).classList.toggle('bad', !good);
}

// A button for each joint that may stand elsewhere than it reads, where the controller can home at all.
function showHomes({ status }) {
  const wanted = verbs.home ? (status.unreferenced ?? '') : '';
  if (byId('homes').dataset.joints === wanted) return;
  byId('homes').dataset.joints = wanted;
  byId('homes').replaceChildren(...wanted.split(',').filter(Boolean).map((joint) => {
    const button = element('button', { type: 'button', 'data-verb': 'home', 'data-joint': joint, 'data-sure': `Home joint ${joint}: sure?`, disabled: '' }, `Home joint ${joint}`);
    button.addEventListener('click', () => press(button));
    return button;
  }));
}

function showButtons(next) {
  const free = state !== null && stale() === '' && state.holds && state.busy === '' && asked === '';
  if (state !== null) jog.show(state.status, free && possible('move', state, verbs));
  for (const button of document.querySelectorAll('[data-verb]:not(.stop)')) {
    const can = free && possible(button.dataset.verb, state, verbs);
    button.disabled = !can;
    button.hidden = !can && ['pause', 'resume', 'acknowledge', 'reset'].includes(button.dataset.verb);
    button.classList.toggle('next', button.dataset.verb === next && can);
  }
  byId('touching').hidden = !verbs.touch;
  const away = state !== null && !state.holds;
  byId('read-only').hidden = !away;
  if (away) tell('read-only-words', state.free ? 'Nobody holds the controls.' : 'You are looking on: another viewer holds the controls. Quick stop is yours all the same.');
}

function showStale() {
  const why = stale();
  if (why !== '') asked = '';  // no answer may come
  document.body.classList.toggle('stale', why !== '');
  byId('lost').hidden = why === '';
  tell('lost', why);
  tell('mode', why === '' ? state.status.mode : 'not known');
  document.body.dataset.mode = why === '' ? state.status.mode : 'unknown';
  document.title = why === '' ? `${state.status.mode} – armsig` : 'armsig: no news';
  tell('link', why === '' ? (state.viewers > 1 ? `${state.viewers} viewers` : 'live') : '');
}

function show() {
  showStale();
  if (Object.keys(state.status).length === 0) return;
  const { headline, words, next } = situation(state, pausedBy, joints.length);
  tell('headline', headline);
  tell('advice', words);
  showProgress(state);
  showVerdict(state);
  showFault(state);
  showFacts(state);
  showReadings(state);
  showAnswer(state);
  showHomes(state);
  showButtons(next);
  arm.setStatus(state.status);
  dials.show(rows, state.sigmas, Number(state.status.sweep ?? 0));
}

// --- What the viewer wants -------------------------------------------------------------------------

async function request(verb, values = {}) {
  if (verb !== 'stop' && verb !== 'take-over') {
    asked = verb;  // one at a time: a second would be refused
    showButtons('');
  }
  const answer = await fetch('request', {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ viewer, verb, ...values }),
    signal: AbortSignal.timeout(3000),
  }).catch(() => null);
  if (answer?.ok) return;
  if (asked === verb) asked = '';
  say(verb, answer ? `${verb}: ${await answer.text()}` : `${verb} did not reach the page’s server${verb === 'stop' ? ': use the emergency stop' : ''}`, false);
}

// What is typed beside Identify, as it is: the server has the bounds. Null: no number, which a browser tells as if it were empty.
function typedValues() {
  const fields = [['accuracy_mm', byId('accuracy')], ['minutes', byId('minutes')]];
  if (fields.some(([, field]) => field.validity.badInput)) return null;
  return Object.fromEntries(fields.filter(([, field]) => field.value !== '').map(([key, field]) => [key, Number(field.value)]));
}

function ask({ verb, joint }) {
  const values = verb === 'identify' ? typedValues() : verb === 'touch' ? { place: byId('place').value } : joint ? { joint: Number(joint) } : {};
  if (values === null) say(verb, `${verb}: what is typed is no number`, false);
  else request(verb, values);
}

function calm(button) {
  if (button.classList.contains('sure')) button.textContent = button.dataset.words;
  button.classList.remove('sure');
}

// A button with data-sure is asked twice.
function press(button) {
  const { sure } = button.dataset;
  if (!sure || button.classList.contains('sure')) {
    calm(button);
    ask(button.dataset);
    return;
  }
  button.dataset.words = button.textContent;
  button.textContent = sure;
  button.classList.add('sure');
  setTimeout(calm, kSure_ms, button);
}

for (const button of document.querySelectorAll('[data-verb]')) button.addEventListener('click', () => press(button));
byId('take-over').addEventListener('click', () => request('take-over'));
setInterval(() => {
  showStale();
  if (state) showButtons(stale() ? '' : situation(state, pausedBy, joints.length).next);
}, 250);

fetch('advice.json').then((answer) => answer.json()).then(setAdvice).catch(() => {});
listen();
