// SPDX-License-Identifier: MIT
// What the state of the controller means to a person: what is the matter, what is next, and what can be asked for.

let advice = {};     // by the name of a message: what happened, and what to do
export const setAdvice = (told) => { advice = told; };

export const adviceFor = (name) => advice[name] ?? { happened: name ?? '', todo: '' };
export const upper = (text) => text.replace(/^./, (c) => c.toUpperCase());
export const markdown = (text) => text.replace(/\[([^\]]*)\]\([^)]*\)/g, '$1').replace(/`/g, '');

// The name of what is wrong with the sensor, now or when the measurement paused; empty: nothing.
export function troubleOf(status, pausedBy) {
  if (status.sensor && status.sensor !== 'well') return status.sensor;
  return status.sequence === 'paused' ? pausedBy : '';
}

// Headline, words, and the verb that is next. `pausedBy`: the name of what paused the measurement.
export function situation({ status, candidate }, pausedBy, jointCount) {
  const running = status.sequence === 'identifying' || status.sequence === 'paused';
  const model = status.model === 'signature' ? 'The arm signature is in use.' : 'The nominal model is in use; the arm itself has not been measured.';
  if (status.mode === 'faulted') {
    const joint = status.fault_joint ? `Joint ${status.fault_joint}: ` : '';
    const words = adviceFor(status.fault).words ?? status.fault ?? 'stopped';
    return { headline: `${joint}${joint ? words : upper(words)}`, words: 'The arm is stopped. It stays so until it is reset.', next: 'reset' };
  }
  if (status.mode === 'starting') {
    if (!status.fault) return { headline: 'Starting', words: 'The drives are found and set up.', next: '' };
    const joint = status.fault_joint ? `Joint ${status.fault_joint}: ` : '';
    const { words, todo } = adviceFor(status.fault);
    const reason = `${joint}${joint ? words ?? status.fault : upper(words ?? status.fault)}`;
    return { headline: 'Waiting', words: `${reason}. ${upper(markdown(todo ?? ''))}.`, next: '' };
  }
  if (status.sequence === 'paused') {
    const name = troubleOf(status, pausedBy);
    const { words, todo } = adviceFor(name);
    return { headline: 'The measurement is paused', words: name ? `${upper(words ?? name)}. ${upper(markdown(todo ?? ''))}. The arm holds where it is; Resume measures the same point again.` : 'The arm holds where it is; Resume measures the same point again.', next: 'resume' };
  }
  if (running) {
    const headline = status.sweep ? `Measuring joint ${status.sweep} of ${jointCount}` : status.refining ? 'Measuring poses anywhere' : 'Comparing on poses held out';
    return { headline, words: 'The arm moves by itself. Keep clear of it.', next: 'pause' };
  }
  if (status.sequence === 'checking') return { headline: 'Checking the arm against its signature', words: 'The arm moves by itself. Keep clear of it.', next: 'halt' };
  if (status.mode === 'homing') return { headline: 'A joint is being homed', words: 'Its drive finds its reference by itself, also beyond the limits. Keep clear of the arm.', next: 'halt' };
  if (status.sequence === 'touching') return { headline: 'Touching the grid', words: 'The arm moves by itself. Keep clear of it.', next: 'halt' };
  if (candidate) {
    const better = candidate.better === 'yes';
    return { headline: better ? 'The candidate is better' : 'The candidate is not better', words: `On ${candidate.validation_poses} validation poses, to which neither was fitted, the tool was off by (RMS):`, next: better ? 'accept' : 'identify' };
  }
  if (status.mode === 'idle') return { headline: 'Without torque', words: `${model} Enable gives the drives torque; the arm holds where it is.`, next: 'enable' };
  if (status.mode === 'servoing') return { headline: 'Moving', words: model, next: 'halt' };
  return { headline: 'Ready', words: `${model} Identify sweeps each joint in turn.`, next: status.model === 'signature' ? '' : 'identify' };
}

// Whether the controller would take the verb now. `verbs`: the modes of each, as it told them, and whether nothing else may be under way.
export function possible(verb, { status, candidate }, verbs) {
  const told = verbs[verb];
  if (!told?.modes.includes(status.mode) || (told.alone && status.sequence !== 'none')) return false;
  return {
    pause: status.sequence === 'identifying', resume: status.sequence === 'paused', accept: candidate?.better === 'yes',
    check: status.model === 'signature', rollback: status.model === 'signature', acknowledge: status.acknowledge === 'needed',
  }[verb] ?? true;
}
